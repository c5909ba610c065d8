#include "weld.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <numeric>
#include <vector>

#include <meshoptimizer.h>

namespace {

// What meshoptimizer compares at once.
constexpr size_t most_streams = 16;
constexpr size_t most_stream_bytes = 256;

// An array with an element for every vertex.
struct Vertices {
    unsigned char *bytes;
    size_t size; // of an element
};

using Arrays = std::vector<Vertices>;

Arrays get_arrays(const girih_cpu_output &output) {
    return {{reinterpret_cast<unsigned char *>(output.positions), 3 * sizeof(float)},
            {reinterpret_cast<unsigned char *>(output.attributes),
             (size_t{3} + output.attribute_floats) * sizeof(float)}};
}

// The vertices from `first` on, cut into what meshoptimizer takes.
std::vector<meshopt_Stream> make_streams(const Arrays &arrays, size_t first) {
    std::vector<meshopt_Stream> streams;
    for (const Vertices &array : arrays) {
        for (size_t at = 0; at < array.size; at += most_stream_bytes) {
            streams.push_back({array.bytes + first * array.size + at,
                               std::min(array.size - at, most_stream_bytes), array.size});
        }
    }
    return streams;
}

// Vertices are the same where `compared` are; `moved` follow them.
void weld(girih_cpu_output &output, const Arrays &compared, const Arrays &moved) {
    std::vector<unsigned int> remap, order;
    // Vertices of the materials before, as they were and as they are: baked, they stand in the
    // order of the materials.
    size_t from = 0;
    size_t to = 0;
    for (uint32_t material = 0; material < output.material_count; ++material) {
        uint32_t *begin = output.indices + size_t{3} * output.material_first[material];
        uint32_t *end = output.indices + size_t{3} * output.material_first[material + 1];
        if (begin == end) {
            continue;
        }
        const size_t count = *std::max_element(begin, end) + size_t{1} - from;
        remap.resize(count);
        // In the order of the vertices, so that none is written over that is still to be moved, and
        // filled up to triangles.
        order.assign((count + 2) / 3 * 3, 0);
        std::iota(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), 0u);
        const std::vector<meshopt_Stream> streams = make_streams(compared, from);
        const size_t welded = meshopt_generateVertexRemapMulti(
            remap.data(), order.data(), order.size(), count, streams.data(), streams.size());
        std::vector<bool> is_moved(welded, false);
        for (size_t n = 0; n < count; ++n) {
            if (is_moved[remap[n]]) {
                continue; // the first of the same stands for all
            }
            is_moved[remap[n]] = true;
            for (const Vertices &array : moved) {
                std::memmove(array.bytes + (to + remap[n]) * array.size,
                             array.bytes + (from + n) * array.size, array.size);
            }
        }
        std::for_each(begin, end, [&](uint32_t &index) {
            index = static_cast<uint32_t>(to) + remap[index - from];
        });
        from += count;
        to += welded;
    }
    output.statistics.output_vertices = to;
}

} // namespace

const char *girih_weld(girih_cpu_output *output, const uint32_t (*keys)[GIRIH_WELD_KEY_WORDS],
                       uint32_t *triangles) {
    try {
        Arrays moved = get_arrays(*output);
        Arrays compared = moved;
        if (keys != nullptr) {
            compared = {{reinterpret_cast<unsigned char *>(
                             const_cast<uint32_t(*)[GIRIH_WELD_KEY_WORDS]>(keys)),
                         sizeof *keys}};
        }
        if (triangles != nullptr) {
            moved.push_back({reinterpret_cast<unsigned char *>(triangles), sizeof *triangles});
        }
        if (make_streams(compared, 0).size() > most_streams) {
            return "too many attributes to weld vertices; use --mode baked";
        }
        weld(*output, compared, moved);
    } catch (const std::exception &) {
        return "out of memory; ask for fewer segments";
    }
    return nullptr;
}
