// What the library and its shaders must agree on: bindings, and the words of every record. Read by
// C and by GLSL alike, so only the preprocessor is used. All storage is arrays of 32-bit words.
#ifndef GIRIH_SHARED_H
#define GIRIH_SHARED_H

// --- The arrays a shader may read or write, and their binding in descriptor set 0 ---------------
//
// The scene's arrays are those of girih_mesh for all meshes one after another, with vertex, edge and
// weld edge numbers counted through.
#define GIRIH_BIND_FRAME 0            // uniform: GirihFrame
#define GIRIH_BIND_VERTICES 1         // scene: position and normal, 6 floats; where the scene keeps them, the
                                      // same again as they were in the previous frame
#define GIRIH_BIND_ATTRIBUTES 2       // scene: attribute_floats floats a vertex
#define GIRIH_BIND_TRIANGLE_VERTICES 3 // scene: 3
#define GIRIH_BIND_TRIANGLE_EDGES 4   // scene: 3 x (edge | GIRIH_EDGE_REVERSED | GIRIH_EDGE_SEAM)
#define GIRIH_BIND_TRIANGLE_MATERIALS 5 // scene: material | GIRIH_TWO_SIDED
#define GIRIH_BIND_EDGE_POINTS 6      // scene: 2 vertices
#define GIRIH_BIND_SEAMS 7            // scene: 4 vertices
#define GIRIH_BIND_TRIANGLE_WELD_EDGES 8 // scene: 3 x (weld edge | GIRIH_WELD_REVERSED)
#define GIRIH_BIND_WELD_EDGES 9       // scene: its edge, and the triangle's edge (3 * triangle + 0..2) that owns it
#define GIRIH_BIND_POINTS 10          // scene: per vertex the vertex that stands for its point, and the
                                      // corner (3 * triangle + 0..2) that owns the vertex
#define GIRIH_BIND_EDGES 11           // scene: per edge the weld edge that stands for all of its own, and the
                                      // triangle's edge (3 * triangle + 0..2) that owns it
#define GIRIH_BIND_PATTERNS 12        // catalogue: GIRIH_PATTERN_WORDS a rank, then one word a range: rank
#define GIRIH_BIND_PATTERN_VERTICES 13 // catalogue: u | v << 16
#define GIRIH_BIND_PATTERN_INDICES 14 // catalogue: one word each, for draws; then, from an even word on,
                                      // the patterns' triangles for output, two words each
#define GIRIH_BIND_INSTANCES 15       // plan: GIRIH_INSTANCE_WORDS each, one more at the end
#define GIRIH_BIND_BLOCKS 16          // plan: the instance of every 64th triangle, edge, weld edge, welded corner
#define GIRIH_BIND_LEVELS 17          // plan: one level an instance's edge
#define GIRIH_BIND_SPLITS 18          // plan: the parts of split triangles, GIRIH_SPLIT_WORDS each
#define GIRIH_BIND_KEYS 19            // plan: one key an instance's triangle, then one a part
#define GIRIH_BIND_ITEMS 20           // plan: the sorted triangles, GIRIH_ITEM_WORDS each
#define GIRIH_BIND_ITEMS_SPARE 21     // plan: the same, where the sort takes more than one pass
#define GIRIH_BIND_COUNTERS 22        // plan: the sort's and the scan's counters
#define GIRIH_BIND_GROUPS 23          // plan: GIRIH_GROUP_WORDS a group, one more at the end
#define GIRIH_BIND_STATUS 24          // plan: GIRIH_STATUS_WORDS, then one word a rank: in use, then
                                      // each material's first output triangle and their end
#define GIRIH_BIND_DRAWS 25           // plan: VkDrawIndexedIndirectCommand
#define GIRIH_BIND_WELD_OFFSETS 26    // plan: per instance's weld edge, its first output vertex
#define GIRIH_BIND_OUT_POSITIONS 27   // output: 3 floats, in windows
#define GIRIH_BIND_OUT_ATTRIBUTES 28  // output: normal, attributes and, where wanted, the previous frame's
                                      // position, in windows; instanced: patches
#define GIRIH_BIND_OUT_INDICES 29     // output: 3 a triangle, in windows
#define GIRIH_BIND_OUT_CLOSED_INDICES 30 // output: 3 a triangle, in windows
#define GIRIH_BIND_OUT_SOURCES 31     // output: instance and triangle of each output triangle, in windows
#define GIRIH_BIND_COUNT 32

// Where only four storage buffers a stage may be had: all arrays of the scene and the catalogue in
// one, all of the plan in another. Positions and attributes keep theirs, and each of the index lists
// is written by a dispatch of its own through the binding of the positions.
#define GIRIH_BIND_SHARED_SCENE 1
#define GIRIH_BIND_SHARED_PLAN 15
#define GIRIH_BIND_SHARED_LIST 27

// --- Marks in the scene's words ------------------------------------------------------------------
#define GIRIH_EDGE_SEAM 0x80000000u     // the edge is a seam: its curve is the mean of two sides'
#define GIRIH_EDGE_REVERSED 0x40000000u // the triangle runs along it against its canonical order
#define GIRIH_EDGE_MASK 0x3fffffffu
#define GIRIH_WELD_REVERSED 0x80000000u
#define GIRIH_WELD_MASK 0x7fffffffu
#define GIRIH_TWO_SIDED 0x80000000u
#define GIRIH_MATERIAL_MASK 0xffffu

#define GIRIH_VERTEX_WORDS 6

// --- Instances: a mesh placed in the world --------------------------------------------------------
//
// Triangles, edges and weld edges of all instances are counted through as the plan's; "first" is the
// plan's number of an instance's first one, and the one after the last instance closes the last
// range. Deltas turn a scene number into a plan number by wrapping addition.
#define GIRIH_INSTANCE_WORDS 60
#define GIRIH_INSTANCE_TRANSFORM 0       // 12 floats: rows of mesh to world
#define GIRIH_INSTANCE_NORMAL 12         // 3 rows of 3 floats and the next three words: the inverse
                                         // transpose, times |determinant|
#define GIRIH_INSTANCE_FLAGS 15
#define GIRIH_INSTANCE_SCALE 19          // float: the cube root of |determinant|
#define GIRIH_INSTANCE_MESH_TRIANGLE 23  // the mesh's first scene triangle
#define GIRIH_INSTANCE_PREVIOUS 24       // words 0 to 22 as they were in the previous frame: what to
                                         // add to their numbers
#define GIRIH_INSTANCE_FIRST_TRIANGLE 48
#define GIRIH_INSTANCE_FIRST_EDGE 49
#define GIRIH_INSTANCE_FIRST_WELD_EDGE 50
#define GIRIH_INSTANCE_FIRST_CORNER 51   // welded output vertices at corners
#define GIRIH_INSTANCE_TRIANGLE_DELTA 52 // plan triangle = scene triangle + delta
#define GIRIH_INSTANCE_EDGE_DELTA 53     // plan edge = scene edge + delta
#define GIRIH_INSTANCE_SEAM_DELTA 54     // seam = scene edge + delta
#define GIRIH_INSTANCE_WELD_DELTA 55     // plan weld edge = scene weld edge + delta
#define GIRIH_INSTANCE_VERTEX_DELTA 56   // welded output vertex of a corner = scene vertex + delta

#define GIRIH_INSTANCE_MIRRORED 1u       // the transform turns the winding round

#define GIRIH_BLOCK 64u                  // triangles, edges, weld edges or corners to one word of BLOCKS

// --- The catalogue on the device ------------------------------------------------------------------
//
// A range is a base pattern with one winding. Patterns with i > j > k have two, forward and mirrored;
// the others need one, because the tie rule of select gives them the permutation that keeps the
// winding.
#define GIRIH_PATTERN_WORDS 12
#define GIRIH_PATTERN_SEGMENTS 0       // 3
#define GIRIH_PATTERN_VERTICES 3
#define GIRIH_PATTERN_TRIANGLES 4
#define GIRIH_PATTERN_FIRST_VERTEX 5
#define GIRIH_PATTERN_FIRST_INDEX 6    // forward range, into PATTERN_INDICES
#define GIRIH_PATTERN_FIRST_MIRRORED 7 // mirrored range; equal to the forward one where there is none
#define GIRIH_PATTERN_RANGE 8          // number of the forward range; the mirrored one follows
#define GIRIH_PATTERN_REPLICAS 9       // copies of the indices, one after another, for baked draws
#define GIRIH_PATTERN_CHUNKS 10        // invocations that share one triangle's vertices
#define GIRIH_PATTERN_FIRST_TRIANGLE 11 // pair of PATTERN_INDICES with the forward range's first triangle; a
                                       // mirrored range follows

// A triangle's corners a, b, c are bits 0, 21 and 42 of its 64, so that one load brings all of them.
#define GIRIH_TRIANGLE_BITS 21u
#define GIRIH_TRIANGLE_MASK 0x1fffffu

#define GIRIH_CHUNK_VERTICES 256u      // vertices an invocation evaluates at most
#define GIRIH_DRAW_WORDS 5u            // VkDrawIndexedIndirectCommand
#define GIRIH_DRAW_TRIANGLES 2048u     // triangles a baked draw's replicas hold at most, if more than one

// --- Splitting ------------------------------------------------------------------------------------
//
// A triangle with an edge of more segments than the catalogue holds is split by a base pattern, its parts if need be
// again. Parts are numbered as the plan's triangles after all of the instances' own.
#define GIRIH_SPLIT_WORDS 12
#define GIRIH_SPLIT_ROOT 0             // the plan's triangle that it is a part of
#define GIRIH_SPLIT_LEVELS 1           // of edges 1 and 2, 16 bits each; of edge 3, and GIRIH_SPLIT_FIRST
#define GIRIH_SPLIT_ITEM 3             // one more than its item; 0: it has none
#define GIRIH_SPLIT_CORNERS 4          // of each corner the weights of the root's corners 1 and 2, 24 bits each, and
                                       // above them 8 bits each of the segments, less one, of a root's edge

#define GIRIH_SPLIT_FIRST 0x10000u     // stands for the whole root when the frame is drawn at level 0
#define GIRIH_SPLIT_WEIGHT_BITS 24u
#define GIRIH_SPLIT_WEIGHT_MASK 0xffffffu
// A root's weights are over 2^23, so that places between those of a pattern (over 2^15) can be told apart, and a float
// still holds each of them.
#define GIRIH_SPLIT_UNIT 256u          // of a pattern's weight in a root's
#define GIRIH_SPLIT_ONE 0x800000u
#define GIRIH_SPLIT_MOST_SEGMENTS 64u  // that an edge is split into at once: a lane's turns are counted
#define GIRIH_SPLIT_LEAST_SEGMENTS 8u  // linear: that are left to a part: very small parts cost more than they do
#define GIRIH_SPLIT_MOST_PARTS 0x40000000u // that are counted
#define GIRIH_MOST_SEGMENTS 32768u     // of an edge: one to a unit of a pattern's weights

// --- Sorting --------------------------------------------------------------------------------------
//
// A key is group << 3 | lambda, and group = material * ranges + range.
#define GIRIH_KEY_CULLED 0xffffffffu
#define GIRIH_KEY_SPLIT 0x80000000u    // on a key: its parts are drawn, unless they found no room
#define GIRIH_ITEM_WORDS 2
#define GIRIH_ITEM_TRIANGLE 0          // the plan's triangle, or part
#define GIRIH_ITEM_KEY 1

#define GIRIH_GROUP_WORDS 16
#define GIRIH_GROUP_FIRST 0            // item
#define GIRIH_GROUP_END 1              // item
#define GIRIH_GROUP_FIRST_VERTEX 2     // output vertex; welded: output vertex in the interior of a triangle
#define GIRIH_GROUP_FIRST_TRIANGLE 3   // output triangle
#define GIRIH_GROUP_FIRST_DRAW 4       // baked draw, over all materials
#define GIRIH_GROUP_FIRST_CHUNK 5      // further chunk (beyond a triangle's first)
// What evaluate and output need of an item of the group, as it is drawn: after an overflow these are base
// pattern [0,0,0]'s for all of a material's groups.
#define GIRIH_GROUP_RANK 6             // base pattern | GIRIH_GROUP_MIRRORED
#define GIRIH_GROUP_VERTICES 8         // of the pattern; this and the next three are read as one
#define GIRIH_GROUP_PATTERN_VERTEX 9   // the pattern's first in PATTERN_VERTICES
#define GIRIH_GROUP_BASE_VERTEX 10     // item n's first output vertex = base + n * vertices (welded: interior ones)
#define GIRIH_GROUP_BASE_TRIANGLE 11   // item n's first output triangle = base + n * triangles
#define GIRIH_GROUP_PATTERN_TRIANGLE 12 // pair of PATTERN_INDICES with the range's first triangle; this and the
                                       // next three are read as one
#define GIRIH_GROUP_TRIANGLES 13       // of the pattern
#define GIRIH_GROUP_EDGE_ENDS 14       // pattern vertices before the inner ones of edge 2 | of edge 3 << 16
#define GIRIH_GROUP_INTERIOR 15        // pattern vertices before the interior ones

#define GIRIH_GROUP_MIRRORED 0x80000000u // uses its pattern's mirrored range

// --- Status: what the host may read after a frame ---------------------------------------------------
#define GIRIH_STATUS_WORDS 52
#define GIRIH_STATUS_ITEMS 0            // triangles and parts that are drawn
#define GIRIH_STATUS_CLAMPED 1          // edges that asked for more than the last level
#define GIRIH_STATUS_FLAGS 2
#define GIRIH_STATUS_VERTICES 3         // output, as drawn
#define GIRIH_STATUS_TRIANGLES 4
#define GIRIH_STATUS_NEEDED_VERTICES 5  // low, high: what the levels asked for
#define GIRIH_STATUS_NEEDED_TRIANGLES 7 // low, high
#define GIRIH_STATUS_GROUPS 9           // not empty
#define GIRIH_STATUS_PATTERNS 10        // base patterns in use
#define GIRIH_STATUS_CHUNKS 11          // further chunks
#define GIRIH_STATUS_WELD_VERTICES 12   // low, high: output vertices inside weld edges
#define GIRIH_STATUS_EVALUATE 16        // VkDispatchIndirectCommand of evaluate and output
#define GIRIH_STATUS_INTERIOR 20        // the same, from the first item on that adds vertices of its own
#define GIRIH_STATUS_FIRST_INTERIOR 23  // that item
#define GIRIH_STATUS_SPLITS 24          // parts; 0 after an overflow of theirs
#define GIRIH_STATUS_NEEDED_SPLITS 25   // parts that were asked for, as far as they are known: with those of each pass
#define GIRIH_STATUS_SPLIT_ROOTS 26     // triangles of instances that are split
#define GIRIH_STATUS_SPLIT_AGAIN 27     // parts that are split
#define GIRIH_STATUS_SPLIT_PASS 28      // of even passes, then of odd ones: GIRIH_SPLIT_PASS_WORDS
#define GIRIH_SPLIT_PASS_MARKS 0        // VkDispatchIndirectCommand of what looks through the parts of the pass before
#define GIRIH_SPLIT_PASS_SPLITS 3       // VkDispatchIndirectCommand of what goes through the list
#define GIRIH_SPLIT_PASS_FIRST 6        // what the pass may have to split: first part and end
#define GIRIH_SPLIT_PASS_END 7
#define GIRIH_SPLIT_PASS_COUNT 8        // what it splits: numbers in the list
#define GIRIH_SPLIT_PASS_WORDS 9
#define GIRIH_STATUS_PARTS 46           // VkDispatchIndirectCommand of evaluate: the parts, then the further chunks
#define GIRIH_STATUS_SPLIT_UNDONE 49    // parts that were to be split after the last pass: none should be

#define GIRIH_STATUS_OVERFLOW 1u        // the frame was drawn at level 0 because it did not fit
#define GIRIH_STATUS_SPLIT_OVERFLOW 2u  // the parts found no room

// --- Frame ------------------------------------------------------------------------------------------
#define GIRIH_LEVELS_UNIFORM 0u
#define GIRIH_LEVELS_RANDOM 1u
#define GIRIH_LEVELS_LENGTH 2u          // world length against the distance to the eye
#define GIRIH_LEVELS_OBJECT_LENGTH 3u   // mesh-space length
#define GIRIH_LEVELS_RANDOM_LEVEL 4u    // the number drawn below random_segments is the level itself
#define GIRIH_LEVELS_HORIZONTAL 5u      // horizontal angle at the eye

#define GIRIH_MAX_LEVELS 256u           // of a catalogue: catalogue.c opens no larger one

#define GIRIH_CULL_FRUSTUM 1u
#define GIRIH_CULL_BACK 2u

// The uniform block of every stage: std140 in GLSL, the same bytes in C. Floats and words after the
// vectors are packed, so the order of the fields is the layout.
#define GIRIH_FRAME_BLOCK(VEC4, UVEC4, UINT, FLOAT) \
    VEC4 planes[6];          /* world, inside where n.p + d >= 0 */ \
    VEC4 eye;                /* w = 1: the eye; w = 0: the direction towards the viewer */ \
    VEC4 horizontal[2];      /* two unit vectors perpendicular to up and to each other: x and y of the plan */ \
    VEC4 up;                 /* unit vector of the vertical axis */ \
    VEC4 turns[GIRIH_MAX_LEVELS / 2u]; /* cosine and sine of the angle that each level reaches, two levels to a vector */ \
    UVEC4 bases[8];          /* first word of each binding's array, where arrays share a buffer */ \
    UVEC4 only_instance[15]; /* the record of the first instance, for plans that have no other */ \
    UINT rule; \
    UINT uniform_level; \
    UINT random_segments; \
    UINT seed; \
    FLOAT length_factor;     /* an edge asks for n segments: length^2 * factor <= n^2 * distance^2 */ \
    FLOAT near_squared; \
    UINT cull; \
    UINT linear_spacing; \
    UINT level_count; \
    UINT last_level;         /* of an edge: where it is beyond the catalogue's, triangles are split */ \
    UINT max_splits;         /* room for parts */ \
    UINT split_passes; \
    UINT triangle_count;     /* of all instances, as the next two */ \
    UINT edge_count; \
    UINT weld_edge_count; \
    UINT corner_count;       /* welded output vertices at corners */ \
    UINT instance_count; \
    UINT range_count; \
    UINT pattern_count; \
    UINT material_count; \
    UINT group_count;        /* material_count * range_count */ \
    UINT output_mode; \
    UINT sort_block;         /* keys of one block of the sort */ \
    UINT sort_block_count; \
    UINT scan_block_count;   /* blocks of GIRIH_SCAN_BLOCK weld edges */ \
    UINT max_vertices; \
    UINT max_triangles; \
    UINT draws_per_material; /* 0: none */ \
    UINT pattern_draws;      /* 1: baked draws use the catalogue's indices; 0: one draw of OUT_INDICES */ \
    UINT attribute_floats; \
    UINT triangle_blocks;    /* first word in BLOCKS of the triangles' instances */ \
    UINT edge_blocks; \
    UINT weld_blocks; \
    UINT corner_blocks; \
    UINT uniform_clamped;    /* 1: uniform_level has fewer segments than were asked for */ \
    UINT attribute_stride;   /* words of an output vertex in OUT_ATTRIBUTES */ \
    UINT previous_vertices;  /* first vertex of the previous frame's VERTICES; 0: they are the current ones */ \
    UINT variant;            /* GIRIH_VARIANT_*, for shaders that are not specialized */ \
    UINT first_index;        /* of the catalogue's indices in the buffer that draws bind */ \
    UINT first_list_index;   /* of OUT_INDICES in the buffer that draws bind */ \
    UINT cylindrical;        /* 1: the frustum is also bounded by slopes */ \
    FLOAT lowest_slope;      /* height above the eye over distance from the axis */ \
    FLOAT highest_slope; \
    FLOAT reach;             /* mesh units: how far the surface strays from its control points' box */

// What differs between the dispatches of one frame.
#define GIRIH_PUSH_BLOCK(UINT) \
    UINT shift;              /* group: the digit is group number >> shift ... */ \
    UINT bins;               /* ... modulo bins, a power of two */ \
    UINT first_pass;         /* group: reads KEYS, else the items of the pass before; small: how many passes, */ \
                             /* each of a digit of `shift` bits */ \
    UINT to_spare;           /* group: writes ITEMS_SPARE (and reads ITEMS), else the other way round */ \
    UINT window_first;       /* evaluate, output: first vertex, triangle or item of the bound window */ \
    UINT window_count;

// --- Variants -----------------------------------------------------------------------------------------
//
// What a frame does not need is compiled out by one specialization constant, because a CPU device runs
// both sides of every branch.
#define GIRIH_VARIANT_INSTANCES 1u      // more than one instance
#define GIRIH_VARIANT_SEAMS 2u          // the scene has seams
#define GIRIH_VARIANT_ATTRIBUTES 4u     // the vertices have attributes
#define GIRIH_VARIANT_CULL 8u           // select culls
#define GIRIH_VARIANT_WELDED 16u        // GIRIH_OUTPUT_WELDED
#define GIRIH_VARIANT_RULE_SHIFT 5u     // levels: the rule, 3 bits
#define GIRIH_VARIANT_DYNAMIC 256u      // the host moves the vertices: positions are read through POINTS
#define GIRIH_VARIANT_PREVIOUS 512u     // the previous frame's positions are written too
#define GIRIH_VARIANT_MATERIALS 1024u   // not every triangle of the scene has material 0 and one side
#define GIRIH_VARIANT_OUTPUT_SHIFT 11u  // output: the index lists that are written, GIRIH_OUTPUT_BIT_*
#define GIRIH_VARIANT_SPLITS 16384u     // triangles may be split
#define GIRIH_VARIANT_PARTS 32768u      // evaluate: the parts alone; without it, where both have kernels, all but them

// --- Modes and workgroups -----------------------------------------------------------------------------
#define GIRIH_OUTPUT_INSTANCED 0u
#define GIRIH_OUTPUT_BAKED 1u
#define GIRIH_OUTPUT_WELDED 2u

#define GIRIH_OUTPUT_BIT_INDICES 1u
#define GIRIH_OUTPUT_BIT_CLOSED_INDICES 2u
#define GIRIH_OUTPUT_BIT_SOURCES 4u

#define GIRIH_SPLIT_BLOCK 128u          // triangles, or parts, that one workgroup splits
#define GIRIH_FEW_GROUPS 16384u         // dispatch: up to so many groups lanes walk on over empty ones, and a serial
                                        // workgroup does it: 65,535 turns are lavapipe's limit
#define GIRIH_WORKGROUP 64
#define GIRIH_LARGE_WORKGROUP 128       // of the stages that do little for each edge or triangle
#define GIRIH_SERIAL_WORKGROUP 8        // where lanes are few: of what one lane, or one workgroup, does alone
#define GIRIH_MAX_BIN_BITS 9u
#define GIRIH_MAX_BINS 512u             // of one pass of the sort
#define GIRIH_MAX_SORT_BLOCK 1024u      // keys of one block of the sort
#define GIRIH_SCAN_BLOCK 256u           // weld edges of one block of their scan
#define GIRIH_SCAN_WORKGROUP 32         // blocks to a workgroup of the scan

// --- Patches: what the instanced mode's vertex shader reads for each triangle --------------------------
//
// In world space, corners already permuted by lambda, so that the base pattern applies unchanged.
#define GIRIH_PATCH_WORDS_FLAT 24       // corners 3x3, normals 3x3, ids 4, padding 2
#define GIRIH_PATCH_WORDS_PN 52         // control points 10x3, normals 6x3, ids 4
#define GIRIH_PATCH_WORDS_PART 8        // after each of these, where triangles may be split: a part's corners, in
                                        // the order of the base pattern, as from GIRIH_SPLIT_CORNERS on; padding 2
#define GIRIH_PATCH_WORDS_OWN 4         // scene triangle, instance, key, rank: the vertex shader gathers the rest
// ids: the three vertices (for attributes), then the item's key

// --- The descriptor set of girih.glsl in a host's vertex shader ------------------------------------------
//
// Surfaces of the library's own read DRAW_ATTRIBUTES alone. A host's surface gathers its patches in the
// vertex shader, from the arrays as they lie where buffers are few: FRAME, SHARED_SCENE, SHARED_PLAN.
#define GIRIH_BIND_DRAW_ATTRIBUTES 2

#endif
