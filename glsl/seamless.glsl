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
};

GirihSeamSides girih_find_seams(GirihPatch patch_) {
    GirihSeamSides seams;
    uint corner = 3u * patch_.triangle;
    for (uint n = 0u; n < 3u; ++n) {
        uint word = TRIANGLE_EDGES(corner + n);
        uint owner = EDGE_OWNERS(word & GIRIH_EDGE_MASK);
        bool same_way = ((word ^ TRIANGLE_EDGES(owner)) & GIRIH_EDGE_REVERSED) == 0u;
        seams.firsts[n] = same_way ? owner : girih_edge_end(owner);
        seams.seconds[n] = same_way ? girih_edge_end(owner) : owner;
        seams.parted[n] = TRIANGLE_VERTICES(seams.firsts[n]) != patch_.vertices[n] ||
                          TRIANGLE_VERTICES(seams.seconds[n]) != patch_.vertices[girih_edge_end(n)];
        seams.points[n] = VERTEX_OWNERS(WELD_POINTS(patch_.vertices[n]));
        seams.apart[n] = TRIANGLE_VERTICES(seams.points[n]) != patch_.vertices[n] ? 1.0 : 0.0;
    }
    return seams;
}

float girih_corner_height(uint corner, GirihPatch asking) {
    GirihPatch patch_ = girih_own_patch(corner / 3u, asking.instance, asking.previous);
    vec3 barycentric = vec3(0.0);
    barycentric[corner % 3u] = 1.0;
    return girih_own_height(patch_, barycentric);
}

// The height at (1 - t, t) between two corners of one triangle, bent to the points' heights at its ends.
float girih_edge_height(uint first, uint second, float t, vec2 points, GirihPatch asking) {
    GirihPatch patch_ = girih_own_patch(first / 3u, asking.instance, asking.previous);
    vec3 barycentric = vec3(0.0);
    barycentric[first % 3u] = 1.0 - t;
    barycentric[second % 3u] = t;
    uint owner1 = VERTEX_OWNERS(WELD_POINTS(patch_.vertices[first % 3u]));
    uint owner2 = VERTEX_OWNERS(WELD_POINTS(patch_.vertices[second % 3u]));
    vec3 apart = vec3(TRIANGLE_VERTICES(owner1) != patch_.vertices[first % 3u] ? 1.0 : 0.0,
                      TRIANGLE_VERTICES(owner2) != patch_.vertices[second % 3u] ? 1.0 : 0.0, 0.0);
    vec3 lacking =
        vec3(points.x - girih_corner_height(first, asking), points.y - girih_corner_height(second, asking), 0.0);
    return girih_own_height(patch_, barycentric) + girih_corners_lacking(vec3(1.0 - t, t, 0.0), apart, lacking);
}

float girih_seamless_height(GirihPatch patch_, vec3 barycentric) {
    GirihSeamSides seams = girih_find_seams(patch_);
    float height = girih_own_height(patch_, barycentric);
    // Loops of no turns instead of branches: a CPU device would run those for every triangle.
    bool seam = seams.parted[0] || seams.parted[1] || seams.parted[2] || seams.apart != vec3(0.0);
    uint turns = seam ? 3u : 0u;
    uint corner = 3u * patch_.triangle;
    vec3 points = vec3(0.0);
    vec3 lacking = vec3(0.0);
    for (uint n = 0u; n < turns; ++n) {
        points[n] = girih_corner_height(seams.points[n], patch_);
        lacking[n] = points[n] - girih_corner_height(corner + n, patch_);
    }
    height += girih_corners_lacking(barycentric, seams.apart, lacking);
    for (uint n = 0u; n < turns; ++n) {
        uint end = girih_edge_end(n);
        float third = barycentric[girih_edge_end(end)];
        float along = barycentric[n] + barycentric[end];
        float weight = (barycentric[n] + third) * (barycentric[end] + third);
        if (!seams.parted[n] || weight == 0.0 || along == 0.0) {
            continue;
        }
        // What the owner makes of the edge, less what is reached already.
        float t = barycentric[end] / along;
        vec2 ends = vec2(points[n], points[end]);
        float wanted = girih_edge_height(seams.firsts[n], seams.seconds[n], t, ends, patch_);
        float reached = girih_edge_height(corner + n, corner + end, t, ends, patch_);
        height += girih_ease(barycentric[n] * barycentric[end] / weight) * (wanted - reached);
    }
    return height;
}

#endif
