// Heights that meet at seams, for own surfaces that displace.
//
// At a UV seam a map differs on the two sides. The owner's height at the edge closes the mesh, but would
// leave a cliff in the first row of vertices beside it. Here each triangle's own heights are bent over its
// whole width to what the owners have at its edges and corners (a transfinite interpolation: the corners'
// differences linearly, what the edges still lack by weights that vanish on the other two). Include it
// after girih.glsl and define
//     float girih_own_height(GirihPatch patch_, vec3 barycentric)
// from what belongs to the patch's vertices (girih_attribute, girih_mesh_place).
#ifndef GIRIH_SEAMLESS_GLSL
#define GIRIH_SEAMLESS_GLSL

float girih_own_height(GirihPatch patch_, vec3 barycentric);

vec3 girih_corner_barycentric(uint corner) {
    vec3 barycentric = vec3(0.0);
    barycentric[corner] = 1.0;
    return barycentric;
}

float girih_seamless_height(GirihPatch patch_, vec3 barycentric) {
    uint corner = 3u * patch_.triangle;
    uint point_owners[3];
    uint edge_owners[3];
    bool same_way[3];
    bool parted[3];
    bool seam = false;
    for (uint n = 0u; n < 3u; ++n) {
        point_owners[n] = VERTEX_OWNERS(WELD_POINTS(patch_.vertices[n]));
        uint word = TRIANGLE_EDGES(corner + n);
        edge_owners[n] = EDGE_OWNERS(word & GIRIH_EDGE_MASK);
        same_way[n] = ((word ^ TRIANGLE_EDGES(edge_owners[n])) & GIRIH_EDGE_REVERSED) == 0u;
        uint near = TRIANGLE_VERTICES(edge_owners[n]);
        uint far = TRIANGLE_VERTICES(girih_edge_end(edge_owners[n]));
        parted[n] = (same_way[n] ? near : far) != patch_.vertices[n] ||
                    (same_way[n] ? far : near) != patch_.vertices[girih_edge_end(n)];
        seam = seam || parted[n] || TRIANGLE_VERTICES(point_owners[n]) != patch_.vertices[n];
    }
    float height = girih_own_height(patch_, barycentric);
    // Loops of no turns instead of a branch: a CPU device would run it for every triangle.
    uint turns = seam ? 3u : 0u;
    float points[3];
    float lacking[3];
    for (uint n = 0u; n < turns; ++n) {
        GirihPatch owner = girih_own_patch(point_owners[n] / 3u, patch_.instance, patch_.previous);
        points[n] = girih_own_height(owner, girih_corner_barycentric(point_owners[n] % 3u));
        lacking[n] = points[n] - girih_own_height(patch_, girih_corner_barycentric(n));
        height += barycentric[n] * lacking[n];
    }
    for (uint n = 0u; n < turns; ++n) {
        uint end = girih_edge_end(n);
        float third = barycentric[girih_edge_end(end)];
        float along = barycentric[n] + barycentric[end];
        float weight = (barycentric[n] + third) * (barycentric[end] + third);
        if (!parted[n] || weight == 0.0 || along == 0.0) {
            continue;
        }
        weight = barycentric[n] * barycentric[end] / weight;
        float t = barycentric[end] / along;
        vec3 own = vec3(0.0);
        own[n] = 1.0 - t;
        own[end] = t;
        GirihPatch owner = girih_own_patch(edge_owners[n] / 3u, patch_.instance, patch_.previous);
        uint first = (same_way[n] ? edge_owners[n] : girih_edge_end(edge_owners[n])) % 3u;
        uint second = (same_way[n] ? girih_edge_end(edge_owners[n]) : edge_owners[n]) % 3u;
        vec3 theirs = vec3(0.0);
        theirs[first] = 1.0 - t;
        theirs[second] = t;
        // What the owner makes of the edge, with its own corners bent to the points' heights, less what is
        // reached already.
        float wanted = girih_own_height(owner, theirs) +
                       (points[n] - girih_own_height(owner, girih_corner_barycentric(first))) * (1.0 - t) +
                       (points[end] - girih_own_height(owner, girih_corner_barycentric(second))) * t;
        float reached = girih_own_height(patch_, own) + lacking[n] * (1.0 - t) + lacking[end] * t;
        height += weight * (wanted - reached);
    }
    return height;
}

#endif
