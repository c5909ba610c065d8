// Heights that meet at seams, for own surfaces that displace.
//
// At a UV seam a map differs on the two sides. The owner's height at the edge closes the mesh, but would
// leave a cliff in the first row of vertices beside it. Here each triangle's own heights are bent over its
// whole width to what the owners have at its edges and corners (a transfinite interpolation: first what
// the corners lack, then what the edges still lack, by weights that end smoothly where they vanish).
// Include it after girih.glsl and define
//     float girih_own_height(GirihPatch patch_, vec3 barycentric)
// from what belongs to the patch's vertices (girih_attribute, girih_mesh_place).
#ifndef GIRIH_SEAMLESS_GLSL
#define GIRIH_SEAMLESS_GLSL

float girih_own_height(GirihPatch patch_, vec3 barycentric);

// From 0 to 1, level at both.
float girih_ease(float x) {
    return x * x * (3.0 - 2.0 * x);
}

// What corners of these weights lack, `apart` marking those (1, else 0) where anything can be lacking:
// in full where they weigh everything, ending smoothly where they weigh nothing.
float girih_corners_lacking(vec3 weights, vec3 apart, vec3 lacking) {
    float sum = girih_dot(weights, apart);
    return sum > 0.0 ? girih_ease(sum) / sum * girih_dot(weights, lacking) : 0.0;
}

// How a triangle meets its surroundings.
struct GirihSeamSides {
    uint points[3];    // the corners' owners
    uint firsts[3];    // the edges' owners' corners at the edges' first and
    uint seconds[3];   // second ends
    bool parted[3];    // an edge's owner has other vertices there
    vec3 apart;        // 1 where a corner's owner has another vertex
    vec3 owner_apart[3]; // the same of the edges' owners' corners at the two ends
};

float girih_apart(uint corner) {
    uint vertex = GIRIH_AT_TRIANGLE_VERTICES(corner);
    return GIRIH_AT_TRIANGLE_VERTICES(GIRIH_AT_VERTEX_OWNERS(GIRIH_AT_WELD_POINTS(vertex))) != vertex ? 1.0 : 0.0;
}

GirihSeamSides girih_find_seams(GirihPatch patch_) {
    GirihSeamSides seams;
    uint corner = 3u * patch_.triangle;
    for (uint n = 0u; n < 3u; ++n) {
        uint word = GIRIH_AT_TRIANGLE_EDGES(corner + n);
        uint owner = GIRIH_AT_EDGE_OWNERS(word & GIRIH_EDGE_MASK);
        bool same_way = ((word ^ GIRIH_AT_TRIANGLE_EDGES(owner)) & GIRIH_EDGE_REVERSED) == 0u;
        seams.firsts[n] = same_way ? owner : girih_edge_end(owner);
        seams.seconds[n] = same_way ? girih_edge_end(owner) : owner;
        seams.parted[n] = GIRIH_AT_TRIANGLE_VERTICES(seams.firsts[n]) != patch_.vertices[n] ||
                          GIRIH_AT_TRIANGLE_VERTICES(seams.seconds[n]) != patch_.vertices[girih_edge_end(n)];
        seams.points[n] = GIRIH_AT_VERTEX_OWNERS(GIRIH_AT_WELD_POINTS(patch_.vertices[n]));
        seams.apart[n] = girih_apart(corner + n);
        seams.owner_apart[n] = vec3(girih_apart(seams.firsts[n]), girih_apart(seams.seconds[n]), 0.0);
    }
    return seams;
}

// What is asked of one seam side's triangle: its height at a place.
const int girih_seam_corners = 1;  // 1..3: the triangle's own corners
const int girih_seam_points = 4;   // 4..6: its corners' owners
const int girih_seam_edges = 7;    // 7..: four for each edge: itself and its owner at the place nearest to
                                   // this one, the owner's two corners
const int girih_seam_questions = 19;

float girih_seamless_height(GirihPatch patch_, vec3 barycentric) {
    GirihSeamSides seams = girih_find_seams(patch_);
    bool edge = seams.parted[0] || seams.parted[1] || seams.parted[2];
    bool seam = edge || seams.apart != vec3(0.0);
    uint corner = 3u * patch_.triangle;
    float heights[girih_seam_questions];
    float t[3];
    for (uint n = 0u; n < 3u; ++n) {
        float along = barycentric[n] + barycentric[girih_edge_end(n)];
        t[n] = along > 0.0 ? barycentric[girih_edge_end(n)] / along : 0.0;
    }
    // A loop that is left early instead of a branch: a CPU device would run that for every triangle. And
    // one, so that the host's function is compiled into one place.
    int questions = edge ? girih_seam_questions : seam ? girih_seam_edges : girih_seam_corners;
    for (int question = 0; question < questions; ++question) {
        GirihPatch asked = patch_;
        vec3 place = barycentric;
        if (question >= girih_seam_corners) {
            uint n = uint(question - girih_seam_corners) % 3u;
            uint first = question < girih_seam_points ? corner + n : seams.points[n];
            uint second = first;
            float share = 0.0;
            if (question >= girih_seam_edges) {
                n = uint(question - girih_seam_edges) / 4u;
                int which = (question - girih_seam_edges) % 4;
                first = which == 0 ? corner + n : seams.firsts[n];
                second = which == 0 ? corner + girih_edge_end(n) : seams.seconds[n];
                share = which == 2 ? 0.0 : which == 3 ? 1.0 : t[n];
            }
            asked = girih_own_patch(first / 3u, patch_.instance, patch_.previous);
            place = vec3(0.0);
            place[first % 3u] = 1.0 - share;
            if (second != first) {
                place[second % 3u] = share;
            }
        }
        heights[question] = girih_own_height(asked, place);
    }
    float height = heights[0];
    if (!seam) {
        return height;
    }
    vec3 points = vec3(heights[4], heights[5], heights[6]);
    vec3 lacking = points - vec3(heights[1], heights[2], heights[3]);
    height += girih_corners_lacking(barycentric, seams.apart, lacking);
    for (uint n = 0u; n < 3u; ++n) {
        uint end = girih_edge_end(n);
        float third = barycentric[girih_edge_end(end)];
        float weight = (barycentric[n] + third) * (barycentric[end] + third);
        if (!seams.parted[n] || weight == 0.0 || barycentric[n] + barycentric[end] == 0.0) {
            continue;
        }
        // What the owner makes of the edge, its own corners bent to the points too, less what is reached.
        uint first = uint(girih_seam_edges) + 4u * n;
        vec3 weights = vec3(1.0 - t[n], t[n], 0.0);
        vec3 owner_lacking = vec3(points[n] - heights[first + 2u], points[end] - heights[first + 3u], 0.0);
        float wanted =
            heights[first + 1u] + girih_corners_lacking(weights, seams.owner_apart[n], owner_lacking);
        float reached = heights[first] + girih_corners_lacking(weights, vec3(seams.apart[n], seams.apart[end], 0.0),
                                                               vec3(lacking[n], lacking[end], 0.0));
        height += girih_ease(barycentric[n] * barycentric[end] / weight) * (wanted - reached);
    }
    return height;
}

#endif
