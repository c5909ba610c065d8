// A host's shader that uses what the host bound before girih_cmd_refine: descriptor sets 0 and 1, and
// push constants.
#version 450

layout(local_size_x = 16) in;

layout(std430, set = 0, binding = 0) writeonly buffer HostWords {
    uint host_words[];
};
layout(std140, set = 1, binding = 0) uniform HostTable {
    uvec4 host_table[4];
};
layout(push_constant) uniform HostPush {
    uvec4 pushed[4];
};

void main() {
    const uint n = gl_LocalInvocationIndex;
    host_words[n] = 3u * pushed[n / 4u][n % 4u] + host_table[n / 4u][n % 4u];
}
