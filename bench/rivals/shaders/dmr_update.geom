// DMR, pass 2: a subtriangle of the previous frame's intermediate mesh puts out its share of its triangle's new
// pattern (Lorenz and Doellner 2008, section 4.4). DMR_OUTPUT is the most vertices it may put out.
#version 450
#extension GL_GOOGLE_include_directive : require

#include "dmr.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = DMR_OUTPUT) out;

layout(location = 0) flat in uvec2 subtriangle[];
layout(location = 0, xfb_buffer = 0, xfb_stride = 12, xfb_offset = 0) flat out uvec3 vertex;

layout(std430, set = 1, binding = 1) readonly buffer Selection {
    uint selection[];
};
layout(std430, set = 1, binding = 2) readonly buffer Table {
    uvec2 table[];
};
layout(std430, set = 1, binding = 3) readonly buffer Patterns {
    uint patterns[]; // three vertices for each subtriangle
};

void main() {
    uint triangle = subtriangle[0].x;
    uint j = subtriangle[0].y & DMR_SUBTRIANGLE;
    uint pattern = selection[DMR_SELECTION_WORDS * triangle];
    uint required = selection[DMR_SELECTION_WORDS * triangle + 1u];
    uint available = selection[DMR_SELECTION_WORDS * triangle + 2u];
    // floor(j required / available), and of j + 1, without a product beyond 32 bits.
    uint whole = required / available;
    uint rest = required - whole * available;
    uint first = j * whole + j * rest / available;
    uint end = (j + 1u) * whole + (j + 1u) * rest / available;
    uint place = table[pattern & ~DMR_HIDDEN].y;
    uint lambda = place & 7u;
    uint marks = lambda << DMR_LAMBDA_SHIFT | (pattern & DMR_HIDDEN);
    // An odd lambda mirrors the pattern: its triangles are turned over.
    uint second = 1u + (GIRIH_LAMBDA_IS_ODD(lambda));
    for (uint n = first; n < end; ++n) {
        uint from = 3u * ((place >> 3) + n);
        uint word = n | marks;
        vertex = uvec3(triangle, word, patterns[from]);
        EmitVertex();
        vertex = uvec3(triangle, word, patterns[from + second]);
        EmitVertex();
        vertex = uvec3(triangle, word, patterns[from + 3u - second]);
        EmitVertex();
        EndPrimitive();
    }
}
