// What else a host relies on with its own surfaces: normals that are the surface's, culling that
// takes nothing away, the twin on the CPU, and wrong calls that are refused.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "meshes.h"
#include "own_surfaces.h"

#define ROOM 60000u // output triangles

static gpu device;
static own_set textures;
static const own_settings settings = {.height = 0.15f, .phase = 0.3f};
static const girih_mesh *meshes[OWN_MESHES];

static girih_plan_desc plan_of(const girih_scene *scene, const girih_surface_program *program,
                               girih_mode mode) {
    return own_plan_of(scene, program, mode, ROOM);
}

// --- Normals ------------------------------------------------------------------------------------

// The angle in degrees between two vectors that are not 0.
static double angle_between(const double a[3], const float b[3]) {
    double ab = 0, aa = 0, bb = 0;
    for (int axis = 0; axis < 3; ++axis) {
        ab += a[axis] * (double)b[axis];
        aa += a[axis] * a[axis];
        bb += (double)b[axis] * (double)b[axis];
    }
    assert_true(aa * bb > 0); // nor is any of them not a number
    return acos(fmax(-1.0, fmin(1.0, ab / sqrt(aa * bb)))) * 180.0 / acos(-1.0);
}

// The mean angle between the output's normals and those of its fine triangles, weighted by area,
// and the largest, of all points of one welded output.
static void measure_normals(const girih_plan *plan, const gpu_readback *read, double *mean,
                            double *largest) {
    const girih_statistics s = girih_plan_statistics(plan);
    const uint32_t *list = read->words[GIRIH_BIND_OUT_CLOSED_INDICES];
    double(*sums)[3] = calloc((size_t)s.output_vertices + 1, sizeof *sums);
    assert_non_null(sums);
    for (uint64_t n = 0; n < 3 * s.output_triangles; n += 3) {
        double along[2][3], face[3];
        const float *p = own_position(read, list[n]);
        for (int side = 0; side < 2; ++side) {
            const float *q = own_position(read, list[n + 1 + (uint64_t)side]);
            for (int axis = 0; axis < 3; ++axis) {
                along[side][axis] = (double)q[axis] - (double)p[axis];
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            const int y = (axis + 1) % 3, z = (axis + 2) % 3;
            face[axis] = along[0][y] * along[1][z] - along[0][z] * along[1][y];
            for (uint64_t corner = 0; corner < 3; ++corner) {
                sums[list[n + corner]][axis] += face[axis];
            }
        }
    }
    double sum = 0, count = 0;
    *largest = 0;
    for (uint32_t n = 0; n < s.output_vertices; ++n) {
        if (sums[n][0] != 0 || sums[n][1] != 0 || sums[n][2] != 0) {
            const double angle = angle_between(sums[n], own_normal(read, n, 5));
            sum += angle;
            ++count;
            *largest = fmax(*largest, angle);
        }
    }
    *mean = sum / count;
    free(sums);
}

// A wave on smooth meshes, mirrored and scaled ones too: the normals are those of the fine
// triangles, up to how the base surface's normals differ from its own triangles'.
static void normals_follow_the_surface(void **state) {
    (void)state;
    static const float placed[3][12] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                        {-2, 0, 0, 5, 0, 2, 0, 0, 0, 0, 2, 0},
                                        {0, 0, 0.5f, 0, 0.5f, 0, 0, 0, 0, -0.5f, 0, -5}};
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    const girih_mesh *const smooth[2] = {make_icosphere(2), make_torus(32, 16)};
    girih_scene *scene = gpu_scene(&device, context, smooth, 2);
    gpu_readback read = {0};
    for (uint32_t mesh = 0; mesh < 2; ++mesh) {
        for (int place = 0; place < 3; ++place) {
            girih_instance instance = {.mesh = mesh};
            memcpy(instance.transform, placed[place], sizeof instance.transform);
            double mean[2], largest[2];
            for (int wave = 0; wave < 2; ++wave) {
                girih_surface_program *program =
                    own_program(context, &textures, wave ? OWN_WAVE : OWN_IDENTITY, 1);
                girih_plan_desc desc = plan_of(scene, program, GIRIH_MODE_WELDED);
                desc.instances = &instance;
                desc.instance_count = 1;
                desc.max_triangles = 70000;
                girih_plan *plan = own_make_plan(context, desc);
                const girih_frame frame = {
                    .rule = GIRIH_LEVEL_SEGMENTS, .segments = 8, .surface_set = textures.set};
                gpu_refine(&device, plan, &frame, &read);
                assert_false(girih_plan_statistics(plan).overflow);
                measure_normals(plan, &read, &mean[wave], &largest[wave]);
                girih_plan_destroy(plan);
                girih_surface_program_destroy(program);
            }
            printf("%s: normals %.3f degrees off in the mean, %.2f at most; without the wave %.3f, "
                   "%.2f\n",
                   smooth[mesh]->name, mean[1], largest[1], mean[0], largest[0]);
            assert_true(mean[1] < 1.0 && mean[1] < mean[0] + 0.25);
            assert_true(largest[1] < 5.0);
        }
    }
    gpu_readback_free(&device, &read);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
    girih_mesh_destroy(smooth[0]);
    girih_mesh_destroy(smooth[1]);
}

// --- Culling ------------------------------------------------------------------------------------

// Whether any of a triangle lies where all planes are positive: what clipping leaves of it.
static bool touches(float planes[6][4], const float *const corners[3]) {
    double polygon[2][12][3];
    uint32_t count = 3;
    for (int n = 0; n < 3; ++n) {
        for (int axis = 0; axis < 3; ++axis) {
            polygon[0][n][axis] = (double)corners[n][axis];
        }
    }
    for (int plane = 0; plane < 6; ++plane) {
        double(*from)[3] = polygon[plane % 2], (*to)[3] = polygon[(plane + 1) % 2];
        double height[12];
        for (uint32_t n = 0; n < count; ++n) {
            height[n] = (double)planes[plane][3];
            for (int axis = 0; axis < 3; ++axis) {
                height[n] += (double)planes[plane][axis] * from[n][axis];
            }
        }
        uint32_t kept = 0;
        for (uint32_t n = 0; n < count; ++n) {
            const uint32_t next = (n + 1) % count;
            if (height[n] >= 0) {
                memcpy(to[kept++], from[n], sizeof to[0]);
            }
            if ((height[n] >= 0) != (height[next] >= 0)) {
                const double share = height[n] / (height[n] - height[next]);
                for (int axis = 0; axis < 3; ++axis) {
                    to[kept][axis] = from[n][axis] + share * (from[next][axis] - from[n][axis]);
                }
                ++kept;
            }
        }
        count = kept;
    }
    return count > 0;
}

static uint32_t plan_triangle(const uint32_t *source) {
    uint32_t first = 0;
    for (uint32_t n = 0; n < source[0]; ++n) {
        first += meshes[own_instances[n].mesh]->triangle_count;
    }
    return first + source[1];
}

// Six planes around a random place of the scene.
static void draw_planes(uint64_t *random, float planes[6][4]) {
    const float place[3] = {draw_float(random, -3, 3), draw_float(random, -4, 4),
                            draw_float(random, -1, 3)};
    for (int plane = 0; plane < 6; ++plane) {
        float *normal = planes[plane];
        for (int axis = 0; axis < 3; ++axis) {
            normal[axis] = draw_float(random, -1, 1);
        }
        normal[3] = draw_float(random, 0.2f, 2.0f) -
                    (normal[0] * place[0] + normal[1] * place[1] + normal[2] * place[2]);
    }
}

// Culling takes away nothing that can be seen of a displaced surface, and something else.
static void reach_is_kept(void **state) {
    (void)state;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    const float height = 0.4f;
    own_set_write(&textures, (own_settings){.height = height});
    enum { KNOWN, UNKNOWN, STILL, BUILT_IN, PLANS };
    girih_surface_program *const programs[PLANS] = {
        [KNOWN] = own_program(context, &textures, OWN_WAVE, height),
        [UNKNOWN] = own_program(context, &textures, OWN_WAVE, -1),
        [STILL] = own_program(context, &textures, OWN_IDENTITY, 0)};
    girih_plan *plans[PLANS];
    for (int n = 0; n < PLANS; ++n) {
        plans[n] = own_make_plan(context, plan_of(scene, programs[n], GIRIH_MODE_BAKED));
    }
    gpu_readback all = {0}, read = {0};
    uint64_t random = 77, culled = 0, visible = 0, beyond = 0;
    bool *kept = malloc(ROOM);
    assert_non_null(kept);
    for (int turn = 0; turn < 24; ++turn) {
        girih_frame frame = {
            .rule = GIRIH_LEVEL_SEGMENTS, .segments = 8, .surface_set = textures.set};
        draw_planes(&random, frame.planes);
        gpu_refine(&device, plans[KNOWN], &frame, &all);
        frame.cull_frustum = 1;
        frame.cull_back = 1; // an own surface's normals are unknown: this culls nothing
        gpu_refine(&device, plans[KNOWN], &frame, &read);
        const girih_statistics s = girih_plan_statistics(plans[KNOWN]);
        culled += s.culled_triangles;
        memset(kept, 0, ROOM);
        for (uint64_t n = 0; n < s.output_triangles; ++n) {
            kept[plan_triangle(read.words[GIRIH_BIND_OUT_SOURCES] + 2 * n)] = true;
        }
        const uint64_t output = s.input_triangles * 64;
        for (uint64_t n = 0; n < output; ++n) {
            const uint32_t *list = all.words[GIRIH_BIND_OUT_INDICES] + 3 * n;
            const uint32_t *source = all.words[GIRIH_BIND_OUT_SOURCES] + 2 * n;
            if (touches(frame.planes, (const float *const[3]){own_position(&all, list[0]),
                                                              own_position(&all, list[1]),
                                                              own_position(&all, list[2])})) {
                ++visible;
                if (!kept[plan_triangle(source)]) {
                    fail_msg("triangle %u of instance %u was culled, but its wave can be seen",
                             source[1], source[0]);
                }
            }
        }
        gpu_refine(&device, plans[UNKNOWN], &frame, &read);
        assert_int_equal(girih_plan_statistics(plans[UNKNOWN]).culled_triangles, 0);
        // With nothing beyond the control points as much is culled as of the built-in surface.
        frame.cull_back = 0;
        gpu_refine(&device, plans[STILL], &frame, &read);
        gpu_refine(&device, plans[BUILT_IN], &frame, &read);
        const uint64_t still = girih_plan_statistics(plans[STILL]).culled_triangles;
        assert_int_equal(still, girih_plan_statistics(plans[BUILT_IN]).culled_triangles);
        assert_true(still >= s.culled_triangles);
        beyond += still - s.culled_triangles;
    }
    free(kept);
    printf("%llu triangles culled, %llu more without the wave, none of the %llu visible ones\n",
           (unsigned long long)culled, (unsigned long long)beyond, (unsigned long long)visible);
    assert_true(culled > 1000 && beyond > 100 && visible > 10000);
    own_set_write(&textures, settings);
    gpu_readback_free(&device, &all);
    gpu_readback_free(&device, &read);
    for (int n = 0; n < PLANS; ++n) {
        girih_plan_destroy(plans[n]);
        girih_surface_program_destroy(programs[n]);
    }
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

// --- The CPU ------------------------------------------------------------------------------------

static float attribute(const girih_cpu_patch *patch, uint32_t n, const float b[3]) {
    const float *attributes = patch->mesh->attributes + n;
    return (attributes[2 * (size_t)patch->vertices[0]] * b[0] +
            attributes[2 * (size_t)patch->vertices[1]] * b[1]) +
           attributes[2 * (size_t)patch->vertices[2]] * b[2];
}

// TEST_POLYNOMIAL of shaders/test_surfaces.glsl.
static void polynomial(void *user, const girih_cpu_patch *patch, const float barycentric[3],
                       float position[3]) {
    ++*(uint64_t *)user;
    float base[3];
    girih_cpu_base_position(patch, barycentric, base);
    const float s = attribute(patch, 0, barycentric), t = attribute(patch, 1, barycentric);
    const float bend = (s * s - t) * 0.25f + barycentric[0] * barycentric[1];
    for (int axis = 0; axis < 3; ++axis) {
        const float turned = base[(axis + 1) % 3] * base[(axis + 1) % 3];
        position[axis] = base[axis] + (turned + bend) * 0.125f;
    }
}

// The same function on the CPU: positions by their bits, normals up to their roots and divisions.
static void check_cpu(gpu_variant variant) {
    girih_context *context = gpu_variant_context(&device, variant);
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_surface_program *program = own_program(context, &textures, OWN_POLYNOMIAL, -1);
    uint64_t calls = 0, vertices = 0;
    float farthest = 0;
    gpu_readback read = {0};
    for (int mode = GIRIH_MODE_BAKED; mode <= GIRIH_MODE_WELDED; ++mode) {
        girih_plan *plan = own_make_plan(context, plan_of(scene, program, (girih_mode)mode));
        for (uint32_t seed = 1; seed <= 6; ++seed) {
            const girih_frame frame = {.rule = GIRIH_LEVEL_RANDOM,
                                       .segments = 16,
                                       .seed = seed,
                                       .surface_set = textures.set};
            const girih_cpu_desc desc = {.catalogue = variant.linear ? girih_catalogue_linear()
                                                                     : girih_catalogue_dyadic(),
                                         .meshes = meshes,
                                         .mesh_count = OWN_MESHES,
                                         .instances = own_instances,
                                         .instance_count = OWN_INSTANCES,
                                         .surface = GIRIH_SURFACE_OWN,
                                         .mode = (girih_mode)mode,
                                         .outputs = plan->outputs,
                                         .own = polynomial,
                                         .own_user = &calls,
                                         .base = GIRIH_SURFACE_PN,
                                         .reach = -1};
            girih_cpu_output cpu;
            girih_error error = {GIRIH_OK, ""};
            gpu_girih(girih_cpu_refine(&desc, &frame, &cpu, &error), &error);
            gpu_refine(&device, plan, &frame, &read);
            const girih_statistics s = girih_plan_statistics(plan);
            assert_false(s.overflow);
            assert_int_equal(s.output_vertices, cpu.statistics.output_vertices);
            assert_int_equal(s.output_triangles, cpu.statistics.output_triangles);
            assert_memory_equal(read.words[GIRIH_BIND_OUT_POSITIONS], cpu.positions,
                                12 * s.output_vertices);
            assert_memory_equal(read.words[GIRIH_BIND_OUT_INDICES], cpu.indices,
                                12 * s.output_triangles);
            assert_memory_equal(read.words[GIRIH_BIND_OUT_SOURCES], cpu.sources,
                                8 * s.output_triangles);
            if (mode == GIRIH_MODE_WELDED) {
                assert_memory_equal(read.words[GIRIH_BIND_OUT_CLOSED_INDICES], cpu.closed_indices,
                                    12 * s.output_triangles);
            }
            for (uint32_t n = 0; n < s.output_vertices; ++n) {
                const float *attributes = own_normal(&read, n, 5);
                assert_memory_equal(attributes + 3, cpu.attributes + 5 * (size_t)n + 3, 8);
                for (int axis = 0; axis < 3; ++axis) {
                    const float apart =
                        fabsf(attributes[axis] - cpu.attributes[5 * (size_t)n + (size_t)axis]);
                    assert_true(apart <= 2e-5f); // a NaN fails it too
                    farthest = fmaxf(farthest, apart);
                }
            }
            vertices += s.output_vertices;
            girih_cpu_output_free(&cpu);
        }
        girih_plan_destroy(plan);
    }
    printf("%llu vertices as on the CPU, in %llu calls; normals within %g\n",
           (unsigned long long)vertices, (unsigned long long)calls, (double)farthest);
    assert_true(vertices > 100000 && calls > 3 * vertices);
    gpu_readback_free(&device, &read);
    girih_surface_program_destroy(program);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
}

static void cpu_gives_the_same(void **state) {
    (void)state;
    check_cpu((gpu_variant){0});
    check_cpu((gpu_variant){.linear = 1, .few_buffers = 1});
}

// --- Wrong calls --------------------------------------------------------------------------------

static void assert_refused(girih_result result, girih_result expected, const char *word,
                           girih_error *error) {
    assert_int_equal(result, expected);
    assert_int_equal(error->result, expected);
    if (!strstr(error->message, word) || strchr(error->message, '\n')) {
        fail_msg("'%s' does not speak of '%s' in one line", error->message, word);
    }
    *error = (girih_error){0};
}

static void wrong_calls_are_refused(void **state) {
    (void)state;
    const girih_result invalid = GIRIH_ERROR_INVALID_ARGUMENT;
    girih_context *context = gpu_variant_context(&device, (gpu_variant){0});
    girih_context *few = gpu_variant_context(&device, (gpu_variant){.few_buffers = 1});
    assert_false(girih_context_uses_few_buffers(context));
    assert_true(girih_context_uses_few_buffers(few));
    girih_scene *scene = gpu_scene(&device, context, meshes, OWN_MESHES);
    girih_surface_program *program = own_program(context, &textures, OWN_NASTY, 1);
    girih_surface_program *foreign = own_program(few, &textures, OWN_NASTY, 1);
    girih_surface_program *made = NULL;
    girih_plan *plan = NULL;
    girih_error error = {0};

    const girih_surface_program_desc modules = own_program_desc(&textures, OWN_NASTY, 1);
    girih_surface_program_desc desc = modules;
    assert_refused(girih_surface_program_create(NULL, &desc, &made, &error), invalid, "context",
                   &error);
    assert_refused(girih_surface_program_create(context, NULL, &made, &error), invalid, "desc",
                   &error);
    assert_refused(girih_surface_program_create(context, &desc, NULL, &error), invalid, "program",
                   &error);
    desc.base = GIRIH_SURFACE_OWN;
    assert_refused(girih_surface_program_create(context, &desc, &made, &error), invalid, "base",
                   &error);
    desc = modules;
    desc.bake_few = NULL;
    assert_refused(girih_surface_program_create(few, &desc, &made, &error), invalid, "bake_few",
                   &error);
    desc = modules;
    desc.bake = NULL;
    assert_refused(girih_surface_program_create(context, &desc, &made, &error), invalid,
                   "GIRIH_FEW_BUFFERS", &error);
    desc = modules;
    desc.bake += 1;
    desc.bake_bytes -= 4;
    assert_refused(girih_surface_program_create(context, &desc, &made, &error),
                   GIRIH_ERROR_INVALID_DATA, "SPIR-V", &error);
    assert_null(made);

    // Without a module for baking only the instanced mode is left.
    desc = (girih_surface_program_desc){.base = GIRIH_SURFACE_PN};
    gpu_girih(girih_surface_program_create(context, &desc, &made, &error), &error);
    girih_plan_desc wrong = plan_of(scene, made, GIRIH_MODE_BAKED);
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), invalid, "module", &error);
    wrong = plan_of(scene, made, GIRIH_MODE_INSTANCED);
    gpu_girih(girih_plan_create(context, &wrong, &plan, &error), &error);
    girih_plan_destroy(plan);
    plan = NULL;

    wrong = plan_of(scene, foreign, GIRIH_MODE_BAKED);
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), invalid, "of this context",
                   &error);
    wrong.program = NULL;
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), invalid, "program", &error);
    wrong = plan_of(scene, NULL, GIRIH_MODE_BAKED);
    wrong.outputs |= GIRIH_OUTPUT_PREVIOUS;
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), invalid, "previous", &error);
    wrong = plan_of(scene, program, GIRIH_MODE_INSTANCED);
    wrong.outputs |= GIRIH_OUTPUT_PREVIOUS;
    assert_refused(girih_plan_create(context, &wrong, &plan, &error), invalid, "previous", &error);
    assert_null(plan);

    // The set is asked for where girih evaluates the surface, and nothing is recorded without it.
    plan = own_make_plan(context, plan_of(scene, program, GIRIH_MODE_BAKED));
    girih_frame frame = {.rule = GIRIH_LEVEL_SEGMENTS, .segments = 2};
    VkCommandBuffer commands = gpu_begin(&device);
    assert_refused(girih_cmd_refine(plan, commands, &frame, NULL, &error), invalid, "surface_set",
                   &error);
    frame.surface_set = textures.set;
    gpu_girih(girih_cmd_refine(plan, commands, &frame, NULL, &error), &error);
    gpu_run(&device, commands);
    const girih_statistics s = girih_plan_statistics(plan);
    assert_int_equal(s.output_triangles, 4 * s.input_triangles);
    girih_plan_destroy(plan);

    girih_surface_program_destroy(NULL);
    girih_surface_program_destroy(made);
    girih_surface_program_destroy(program);
    girih_surface_program_destroy(foreign);
    girih_scene_destroy(scene);
    girih_context_destroy(context);
    girih_context_destroy(few);
}

int main(void) {
    const girih_requirements requirements = girih_get_requirements();
    gpu_open(&device, &requirements.optional, true);
    textures = own_set_open(&device, settings);
    own_make_meshes(meshes);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_follow_the_surface),
        cmocka_unit_test(reach_is_kept),
        cmocka_unit_test(cpu_gives_the_same),
        cmocka_unit_test(wrong_calls_are_refused),
    };
    if (cmocka_run_group_tests(tests, NULL, NULL)) {
        return 1; // what a failed test left open would only hide why it failed
    }
    own_destroy_meshes(meshes);
    own_set_close(&device, &textures);
    const unsigned messages = gpu_close(&device);
    if (messages) {
        print_error("%u validation messages\n", messages);
    }
    return messages != 0;
}
