// OpenSubdiv's Bfr behind a C interface. No exception leaves this file.
#include "bfr.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <shared_mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/bfr/tessellation.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

namespace {

// Faces that a thread takes at a time: large against the cost of taking them, small against the
// output, so that threads end together.
constexpr uint32_t batch_faces = 64;

using Cache =
    Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex, std::shared_lock<std::shared_mutex>,
                                     std::unique_lock<std::shared_mutex>>;
using Factory = Bfr::RefinerSurfaceFactory<Cache>;

girih_result fail(girih_error *error, girih_result result, const char *reason) noexcept {
    if (error != nullptr) {
        error->result = result;
        std::snprintf(error->message, sizeof error->message, "Bfr: %s", reason);
    }
    return result;
}

// Runs work; an exception becomes a result and one line.
template <typename Work> girih_result guarded(girih_error *error, Work work) noexcept {
    try {
        work();
        return GIRIH_OK;
    } catch (const std::bad_alloc &) {
        return fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "out of memory");
    } catch (const std::length_error &failure) {
        return fail(error, GIRIH_ERROR_TOO_LARGE, failure.what());
    } catch (const std::invalid_argument &failure) {
        return fail(error, GIRIH_ERROR_INVALID_ARGUMENT, failure.what());
    } catch (const std::exception &failure) {
        return fail(error, GIRIH_ERROR_INVALID_DATA, failure.what());
    } catch (...) {
        return fail(error, GIRIH_ERROR_INVALID_DATA, "unknown failure");
    }
}

struct Face {
    int rates[4]; // edges 12, 23, 31, interior
    uint32_t first_vertex, first_triangle;

    Bfr::Tessellation pattern(const Bfr::Parameterization &parameterization) const {
        return Bfr::Tessellation(parameterization, 4, rates);
    }
};

std::unique_ptr<Far::TopologyRefiner> make_refiner(const bench_bfr_desc &desc) {
    const auto most = static_cast<uint32_t>(std::numeric_limits<int>::max());
    if (desc.vertex_count > most || desc.triangle_count > most / 3) {
        throw std::length_error("more vertices or triangles than an int can number");
    }
    const std::vector<int> face_sizes(desc.triangle_count, 3);
    std::vector<int> indices(3 * static_cast<size_t>(desc.triangle_count));
    for (size_t n = 0; n < indices.size(); ++n) {
        if (desc.indices[n] >= desc.vertex_count) {
            throw std::invalid_argument("an index is beyond the vertices");
        }
        indices[n] = static_cast<int>(desc.indices[n]);
    }
    Far::TopologyDescriptor topology;
    topology.numVertices = static_cast<int>(desc.vertex_count);
    topology.numFaces = static_cast<int>(desc.triangle_count);
    topology.numVertsPerFace = face_sizes.data();
    topology.vertIndicesPerFace = indices.data();
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    const auto scheme = desc.scheme == BENCH_BFR_LOOP ? Sdc::SCHEME_LOOP : Sdc::SCHEME_BILINEAR;
    using Refiners = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Refiners::Create(topology, Refiners::Options(scheme, options)));
    if (!refiner) {
        throw std::runtime_error("OpenSubdiv refuses the mesh");
    }
    return refiner;
}

// The unit normal from both derivatives.
void write_normal(const float du[3], const float dv[3], float normal[3]) {
    const float n[3] = {du[1] * dv[2] - du[2] * dv[1], du[2] * dv[0] - du[0] * dv[2],
                        du[0] * dv[1] - du[1] * dv[0]};
    const float square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    const float scale = square > 0.0f ? 1.0f / std::sqrt(square) : 0.0f;
    for (int c = 0; c < 3; ++c) {
        normal[c] = n[c] * scale;
    }
}

} // namespace

struct bench_bfr {
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::unique_ptr<Factory> factory;
    const float *mesh_positions = nullptr;
    std::vector<Face> faces;
    std::vector<float> positions, normals;
    std::vector<uint32_t> indices;

    explicit bench_bfr(const bench_bfr_desc &desc)
        : refiner(make_refiner(desc)), factory(std::make_unique<Factory>(*refiner)),
          mesh_positions(desc.positions), faces(desc.triangle_count) {
        uint64_t vertices = 0;
        uint64_t triangles = 0;
        for (uint32_t n = 0; n < desc.triangle_count; ++n) {
            Face &face = faces[n];
            for (uint32_t edge = 0; edge < 3; ++edge) {
                face.rates[edge] =
                    static_cast<int>(desc.segments[3 * static_cast<size_t>(n) + edge]);
            }
            face.rates[3] = *std::max_element(face.rates, face.rates + 3);
            const Bfr::Tessellation pattern =
                face.pattern(factory->GetFaceParameterization(static_cast<int>(n)));
            if (!pattern.IsValid()) {
                throw std::invalid_argument("segments that Bfr cannot tessellate");
            }
            face.first_vertex = static_cast<uint32_t>(vertices);
            face.first_triangle = static_cast<uint32_t>(triangles);
            vertices += static_cast<uint64_t>(pattern.GetNumCoords());
            triangles += static_cast<uint64_t>(pattern.GetNumFacets());
        }
        // Bfr's indices are ints.
        if (vertices > static_cast<uint64_t>(std::numeric_limits<int>::max()) ||
            triangles > static_cast<uint64_t>(std::numeric_limits<int>::max())) {
            throw std::length_error("more output than an int can number");
        }
        positions.resize(3 * static_cast<size_t>(vertices));
        normals.resize(3 * static_cast<size_t>(vertices));
        indices.resize(3 * static_cast<size_t>(triangles));
    }
};

namespace {

// What a thread keeps from face to face.
struct Worker {
    Bfr::Surface<float> surface;
    std::vector<float> points; // of the patch
    std::vector<float> coordinates;
    std::vector<int> facets;

    void face(bench_bfr &bfr, uint32_t number) {
        const Face &face = bfr.faces[number];
        if (!bfr.factory->InitVertexSurface(static_cast<int>(number), &surface)) {
            throw std::runtime_error("a face has no limit surface");
        }
        const Bfr::Tessellation pattern = face.pattern(surface.GetParameterization());
        const auto vertex_count = static_cast<size_t>(pattern.GetNumCoords());
        coordinates.resize(2 * vertex_count);
        pattern.GetCoords(coordinates.data());
        points.resize(3 * static_cast<size_t>(surface.GetNumPatchPoints()));
        surface.PreparePatchPoints(bfr.mesh_positions, 3, points.data(), 3);
        float *position = bfr.positions.data() + 3 * static_cast<size_t>(face.first_vertex);
        float *normal = bfr.normals.data() + 3 * static_cast<size_t>(face.first_vertex);
        for (size_t n = 0; n < vertex_count; ++n) {
            float du[3], dv[3];
            surface.Evaluate(coordinates.data() + 2 * n, points.data(), 3, position + 3 * n, du,
                             dv);
            write_normal(du, dv, normal + 3 * n);
        }
        facets.resize(3 * static_cast<size_t>(pattern.GetNumFacets()));
        pattern.GetFacets(facets.data());
        uint32_t *index = bfr.indices.data() + 3 * static_cast<size_t>(face.first_triangle);
        for (const int n : facets) {
            *index++ = face.first_vertex + static_cast<uint32_t>(n);
        }
    }
};

void tessellate(bench_bfr &bfr, std::atomic<uint32_t> &next) {
    Worker worker;
    const auto count = static_cast<uint32_t>(bfr.faces.size());
    for (;;) {
        const uint32_t first = next.fetch_add(batch_faces);
        if (first >= count) {
            return;
        }
        const uint32_t end = first + std::min(batch_faces, count - first);
        for (uint32_t number = first; number < end; ++number) {
            worker.face(bfr, number);
        }
    }
}

} // namespace

girih_result bench_bfr_create(const bench_bfr_desc *desc, bench_bfr **bfr, girih_error *error) {
    return guarded(error, [&] { *bfr = new bench_bfr(*desc); });
}

void bench_bfr_destroy(bench_bfr *bfr) {
    delete bfr;
}

girih_result bench_bfr_tessellate(bench_bfr *bfr, uint32_t thread_count, girih_error *error) {
    return guarded(error, [&] {
        std::atomic<uint32_t> next{0};
        std::exception_ptr failure;
        std::mutex failure_mutex;
        const auto work = [&]() noexcept {
            try {
                tessellate(*bfr, next);
            } catch (...) {
                const std::lock_guard<std::mutex> lock(failure_mutex);
                failure = std::current_exception();
            }
        };
        std::vector<std::thread> others;
        others.reserve(thread_count);
        try {
            for (uint32_t n = 1; n < thread_count; ++n) {
                others.emplace_back(work);
            }
            work();
        } catch (...) {
            failure = std::current_exception();
        }
        for (std::thread &thread : others) {
            thread.join();
        }
        if (failure) {
            std::rethrow_exception(failure);
        }
    });
}

bench_bfr_output bench_bfr_result(const bench_bfr *bfr) {
    return {bfr->positions.data(), bfr->normals.data(), bfr->indices.data(),
            static_cast<uint32_t>(bfr->positions.size() / 3),
            static_cast<uint32_t>(bfr->indices.size() / 3)};
}
