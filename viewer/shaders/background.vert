// One triangle that covers the picture.
#version 450

layout(location = 0) out float out_height;

void main() {
    vec2 corner = vec2(float((gl_VertexIndex << 1) & 2), float(gl_VertexIndex & 2));
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
    out_height = corner.y;
}
