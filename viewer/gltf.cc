// The C interface of the glTF loader and writer. No exception leaves this file.
#include "gltf.h"

#include "gltf_model.hh"

#include <cstdio>
#include <exception>
#include <memory>
#include <new>

using namespace girih_gltf;

namespace {

// Runs work; on any exception writes its one line into message and returns false.
template <typename Work>
bool guarded(const char *path, char *message, size_t message_size, Work work) noexcept {
    const char *reason = "unknown failure";
    try {
        try {
            work();
            return true;
        } catch (const std::exception &failure) {
            const std::string line = one_line(std::string(path) + ": " + failure.what());
            if (message != nullptr && message_size > 0) {
                std::snprintf(message, message_size, "%s", line.c_str());
            }
            return false;
        }
    } catch (const std::bad_alloc &) {
        reason = "out of memory";
    } catch (...) {
    }
    if (message != nullptr && message_size > 0) {
        std::snprintf(message, message_size, "%s", reason);
    }
    return false;
}

} // namespace

std::string girih_gltf::one_line(std::string text) {
    for (char &c : text) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
            c = ' ';
        }
    }
    while (!text.empty() && text.back() == ' ') {
        text.pop_back();
    }
    return text;
}

const char *girih_gltf_model::keep_name(std::string name) {
    names.push_back(std::move(name));
    return names.back().c_str();
}

girih_gltf_model *girih_gltf_load(const char *path, void (*warn)(void *user, const char *line),
                                  void *user, char *message, size_t message_size) {
    std::unique_ptr<girih_gltf_model> model;
    const bool loaded = guarded(path, message, message_size, [&] {
        model = std::make_unique<girih_gltf_model>();
        const warner warning(warn, user);
        model->source = std::make_unique<document>(path);
        document &source = *model->source;
        check_extensions(source.root, warning);
        decode_compressed(source);
        load_geometry(*model, source, warning);
        load_image_files(*model, source, warning);
        load_scene(*model, source, warning);
        load_animations(*model, source, warning);
    });
    return loaded ? model.release() : nullptr;
}

void girih_gltf_destroy(girih_gltf_model *model) {
    delete model;
}

const girih_gltf_contents *girih_gltf_get(const girih_gltf_model *model) {
    return &model->contents;
}

bool girih_gltf_write(const girih_gltf_model *model,
                      const girih_gltf_refined_primitive *const *refined, const char *path,
                      void (*warn)(void *user, const char *line), void *user, char *message,
                      size_t message_size) {
    return guarded(path, message, message_size,
                   [&] { write_model(*model, refined, path, warner(warn, user)); });
}
