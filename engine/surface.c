// The host's surfaces: their modules and pipelines.
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "context.h"
#include "error.h"
#include "memory.h"

#define SURFACE_VARIANTS                                                                           \
    (GIRIH_VARIANT_INSTANCES | GIRIH_VARIANT_SEAMS | GIRIH_VARIANT_ATTRIBUTES |                    \
     GIRIH_VARIANT_WELDED | GIRIH_VARIANT_DYNAMIC | GIRIH_VARIANT_PREVIOUS |                     \
     GIRIH_VARIANT_SPLITS)

// Copies the module that the context takes. A surface without modules is drawn in the instanced
// mode alone.
static girih_result take_module(girih_surface_program *program,
                                const girih_surface_program_desc *desc, girih_error *error) {
    const girih_context *context = program->context;
    const uint32_t *words = context->few_buffers ? desc->bake_few : desc->bake;
    const size_t bytes = context->few_buffers ? desc->bake_few_bytes : desc->bake_bytes;
    if (!words && !desc->bake && !desc->bake_few) {
        return GIRIH_OK;
    }
    if (!words) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "surface: this context takes the module %s (%s); compile it too",
                          context->few_buffers ? "bake_few, with GIRIH_FEW_BUFFERS defined"
                                               : "bake, without GIRIH_FEW_BUFFERS defined",
                          "girih_context_uses_few_buffers");
    }
    program->words = girih_allocate(bytes);
    if (!program->words) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "surface: out of memory");
    }
    memcpy(program->words, words, bytes);
    program->bytes = bytes;
    // Compiled for the host's sets already (GIRIH_SET), so it moves nowhere: only whether it is
    // SPIR-V.
    if (!girih_spirv_place(program->words, bytes, 0, 0)) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "surface: the %llu bytes of %s are no SPIR-V module; compile the surface "
                          "for Vulkan 1.1",
                          (unsigned long long)bytes, context->few_buffers ? "bake_few" : "bake");
    }
    return GIRIH_OK;
}

static girih_result create_layout(girih_surface_program *program, VkDescriptorSetLayout own,
                                  girih_error *error) {
    const girih_context *context = program->context;
    if (!own) {
        program->pipeline_layout = context->pipeline_layout;
        return GIRIH_OK;
    }
    return girih_create_pipeline_layout(context, own, "surface", &program->pipeline_layout, error);
}

girih_result girih_surface_program_create(const girih_context *context,
                                          const girih_surface_program_desc *desc,
                                          girih_surface_program **out, girih_error *error) {
    if (!context || !desc || !out) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_surface_program_create: context, desc and program must be set");
    }
    if (desc->base != GIRIH_SURFACE_FLAT && desc->base != GIRIH_SURFACE_PN) {
        return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                          "girih_surface_program_create: base is %d; it must be GIRIH_SURFACE_FLAT "
                          "or GIRIH_SURFACE_PN",
                          (int)desc->base);
    }
    girih_surface_program *program = girih_allocate(sizeof *program);
    if (!program) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "surface: out of memory");
    }
    *program = (girih_surface_program){
        .context = context,
        .base = desc->base,
        .reach = isfinite(desc->reach) && desc->reach >= 0 ? desc->reach : -1};
    girih_result result = take_module(program, desc, error);
    if (result == GIRIH_OK) {
        result = create_layout(program, desc->set_layout, error);
    }
    if (result != GIRIH_OK) {
        girih_surface_program_destroy(program);
        return result;
    }
    *out = program;
    return GIRIH_OK;
}

void girih_surface_program_destroy(girih_surface_program *program) {
    if (!program) {
        return;
    }
    const girih_context *context = program->context;
    for (uint32_t slot = 0; slot < GIRIH_MAX_VARIANTS; ++slot) {
        context->vk.DestroyPipeline(context->device, program->pipelines[slot], context->callbacks);
    }
    if (program->pipeline_layout != context->pipeline_layout) {
        context->vk.DestroyPipelineLayout(context->device, program->pipeline_layout,
                                          context->callbacks);
    }
    girih_free(program->words);
    girih_free(program);
}

girih_result girih_surface_pipeline_need(const girih_surface_program *program, uint32_t variant,
                                         girih_error *error) {
    const _Atomic(VkPipeline) *slot =
        &program->pipelines[girih_variant_slot(variant, SURFACE_VARIANTS)];
    if (atomic_load(slot)) {
        return GIRIH_OK;
    }
    return girih_pipeline_create(program->context, program->words, program->bytes,
                                 variant & SURFACE_VARIANTS, program->pipeline_layout, slot, error);
}

VkPipeline girih_surface_pipeline_get(const girih_surface_program *program, uint32_t variant) {
    return atomic_load(&program->pipelines[girih_variant_slot(variant, SURFACE_VARIANTS)]);
}
