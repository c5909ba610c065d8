// Accessors and primitives: every range is checked before a byte of it is read, since neither the
// file nor tinygltf promises any. glTF 2.0, sections 3.6.2 (accessors, sparse ones) and 3.7.2
// (meshes); KHR_mesh_quantization for integer positions, normals, tangents and coordinates.
#include "gltf_model.hh"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace girih_gltf {
namespace {

enum component_type : unsigned {
    type_i8 = 5120,
    type_u8 = 5121,
    type_i16 = 5122,
    type_u16 = 5123,
    type_u32 = 5125,
    type_f32 = 5126
};

enum primitive_mode : unsigned { mode_triangles = 4, mode_strip = 5, mode_fan = 6 };

// An accessor without data is all zeros, so that nothing in the file bounds its count.
constexpr std::uint64_t greatest_zero_count = 1u << 24;

unsigned component_size(std::uint64_t type, const std::string &where) {
    switch (type) {
    case type_i8:
    case type_u8:
        return 1;
    case type_i16:
    case type_u16:
        return 2;
    case type_u32:
    case type_f32:
        return 4;
    default:
        throw refusal(where + ": unknown component type " + std::to_string(type));
    }
}

// How many components an element has; 0 for matrices, which no attribute that girih keeps uses.
unsigned component_count(const json &accessor) {
    const std::string &type = accessor["type"].get_ref<const std::string &>();
    if (type == "SCALAR") {
        return 1;
    }
    return type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
}

template <typename Integer> float read_integer(const std::uint8_t *from, bool normalized) {
    Integer value;
    std::memcpy(&value, from, sizeof value);
    if (!normalized) {
        return static_cast<float>(value);
    }
    // glTF 2.0, section 3.6.2.2: the most negative value is clamped, so that zero is exact.
    const float quotient =
        static_cast<float>(value) / static_cast<float>(std::numeric_limits<Integer>::max());
    return std::fmax(quotient, -1.0f);
}

float read_component(const std::uint8_t *from, std::uint64_t type, bool normalized) {
    switch (type) {
    case type_i8:
        return read_integer<std::int8_t>(from, normalized);
    case type_u8:
        return read_integer<std::uint8_t>(from, normalized);
    case type_i16:
        return read_integer<std::int16_t>(from, normalized);
    case type_u16:
        return read_integer<std::uint16_t>(from, normalized);
    case type_u32: {
        std::uint32_t value;
        std::memcpy(&value, from, sizeof value);
        return static_cast<float>(value);
    }
    default: {
        float value;
        std::memcpy(&value, from, sizeof value);
        return value;
    }
    }
}

std::uint32_t read_index(const std::uint8_t *from, std::uint64_t type) {
    if (type == type_u8) {
        return *from;
    }
    if (type == type_u16) {
        std::uint16_t value;
        std::memcpy(&value, from, sizeof value);
        return value;
    }
    std::uint32_t value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

// count elements of element_size bytes in a view, a whole number of strides apart.
struct elements {
    const std::uint8_t *data;
    std::size_t stride;
};

elements locate(document &source, std::size_t view_index, std::uint64_t offset, std::uint64_t count,
                std::size_t element_size, const std::string &where) {
    const document::span view = source.view(view_index);
    const std::size_t stride = view.stride == 0 ? element_size : view.stride;
    if (stride < element_size) {
        throw refusal(where + ": the stride of " + std::to_string(stride) +
                      " bytes is smaller than an element of " + std::to_string(element_size));
    }
    if (offset > view.size || element_size > view.size - offset ||
        count - 1 > (view.size - offset - element_size) / stride) {
        throw refusal(where + ": its " + std::to_string(count) + " elements reach beyond the " +
                      std::to_string(view.size) + " bytes of buffer view " +
                      std::to_string(view_index));
    }
    return {view.data + offset, stride};
}

class geometry_loader {
public:
    geometry_loader(girih_gltf_model &model, document &source, const warner &warn)
        : model_(model), source_(source), warn_(warn) {}

    void load();

private:
    const std::vector<float> &values(std::size_t accessor_index, bool always_normalized);
    std::vector<std::uint32_t> index_list(std::size_t accessor_index, std::uint32_t vertex_count,
                                          const std::string &where);
    const float *attribute(std::size_t accessor_index, const std::string &name,
                           std::uint32_t vertex_count, unsigned &components,
                           const std::string &where);
    bool load_primitive(const json &description, const std::string &where,
                        girih_gltf_primitive &primitive);

    girih_gltf_model &model_;
    document &source_;
    const warner &warn_;
};

// An accessor's elements as floats, sparse values applied. Decoded once for all its users.
const std::vector<float> &geometry_loader::values(std::size_t accessor_index,
                                                  bool always_normalized) {
    const std::pair<std::size_t, bool> key(accessor_index, always_normalized);
    const auto known = model_.values.find(key);
    if (known != model_.values.end()) {
        return known->second;
    }
    const json &accessor = source_.root["accessors"][accessor_index];
    const std::string where = label(source_.root, "accessors", "accessor", accessor_index);
    const std::uint64_t type = accessor["componentType"], count = accessor["count"];
    const unsigned size = component_size(type, where), components = component_count(accessor);
    const bool normalized = always_normalized || accessor.value("normalized", false);
    const std::size_t element_size = std::size_t{size} * components;

    elements base = {};
    if (accessor.contains("bufferView")) {
        base = locate(source_, accessor["bufferView"],
                      accessor.value("byteOffset", std::uint64_t{0}), count, element_size, where);
    } else if (count > greatest_zero_count) {
        throw refusal(where + ": " + std::to_string(count) + " elements without data");
    }
    std::vector<float> result(static_cast<std::size_t>(count) * components);
    for (std::size_t i = 0; base.data != nullptr && i < count; i++) {
        for (unsigned c = 0; c < components; c++) {
            result[i * components + c] =
                read_component(base.data + i * base.stride + c * size, type, normalized);
        }
    }
    if (accessor.contains("sparse")) {
        const json &sparse = accessor["sparse"], &sparse_indices = sparse["indices"];
        const std::uint64_t sparse_count = sparse["count"], index_type = sparse_indices["componentT"
                                                                                        "ype"];
        if (index_type != type_u8 && index_type != type_u16 && index_type != type_u32) {
            throw refusal(where + ": sparse indices must be unsigned integers");
        }
        const elements positions =
            locate(source_, sparse_indices["bufferView"],
                   sparse_indices.value("byteOffset", std::uint64_t{0}), sparse_count,
                   component_size(index_type, where), where + ", sparse indices");
        const elements replacements = locate(source_, sparse["values"]["bufferView"],
                                             sparse["values"].value("byteOffset", std::uint64_t{0}),
                                             sparse_count, element_size, where + ", sparse values");
        for (std::size_t i = 0; i < sparse_count; i++) {
            const std::uint32_t target =
                read_index(positions.data + i * positions.stride, index_type);
            if (target >= count) {
                throw refusal(where + ": sparse index " + std::to_string(target) +
                              ", but there are only " + std::to_string(count) + " elements");
            }
            for (unsigned c = 0; c < components; c++) {
                result[std::size_t{target} * components + c] = read_component(
                    replacements.data + i * replacements.stride + c * size, type, normalized);
            }
        }
    }
    return model_.values.emplace(key, std::move(result)).first->second;
}

std::vector<std::uint32_t> geometry_loader::index_list(std::size_t accessor_index,
                                                       std::uint32_t vertex_count,
                                                       const std::string &where) {
    const json &accessor = source_.root["accessors"][accessor_index];
    const std::uint64_t type = accessor["componentType"], count = accessor["count"];
    if (component_count(accessor) != 1 ||
        (type != type_u8 && type != type_u16 && type != type_u32)) {
        throw refusal(where + ": indices must be unsigned integer scalars");
    }
    const unsigned size = component_size(type, where);
    std::vector<std::uint32_t> list;
    if (accessor.contains("sparse") || !accessor.contains("bufferView")) {
        // Floats hold indices exactly below 2^24; beyond, they would name another vertex.
        const std::vector<float> &exact = values(accessor_index, false);
        if (vertex_count > greatest_zero_count) {
            throw refusal(where + ": sparse indices of more than 2^24 vertices are not supported");
        }
        list.reserve(exact.size());
        for (const float value : exact) {
            list.push_back(value < 4294967040.0f ? static_cast<std::uint32_t>(value) : 0xffffffffu);
        }
    } else {
        const elements from =
            locate(source_, accessor["bufferView"], accessor.value("byteOffset", std::uint64_t{0}),
                   count, size, label(source_.root, "accessors", "accessor", accessor_index));
        list.resize(static_cast<std::size_t>(count));
        for (std::size_t i = 0; i < list.size(); i++) {
            list[i] = read_index(from.data + i * from.stride, type);
        }
    }
    const std::uint32_t restart = size == 4 ? 0xffffffffu : (1u << (8 * size)) - 1;
    for (std::size_t i = 0; i < list.size(); i++) {
        if (list[i] == restart) {
            throw refusal(where + ": index " + std::to_string(i) +
                          " is the primitive restart value " + std::to_string(restart) +
                          ", which glTF does not allow");
        }
        if (list[i] >= vertex_count) {
            throw refusal(where + ": index " + std::to_string(i) + " is " +
                          std::to_string(list[i]) + ", but there are only " +
                          std::to_string(vertex_count) + " vertices");
        }
    }
    return list;
}

bool has_prefix(const std::string &name, const char *prefix) {
    return name.compare(0, std::strlen(prefix), prefix) == 0;
}

// TEXCOORD_0 and the like: a prefix and a set number.
bool is_set(const std::string &name, const char *prefix) {
    const std::size_t length = std::strlen(prefix);
    return has_prefix(name, prefix) && name.size() > length &&
           name.find_first_not_of("0123456789", length) == std::string::npos;
}

const char *const attribute_rule = "glTF does not allow this type for it";

// Whether glTF 2.0, section 3.7.2.1, or KHR_mesh_quantization allows the type for the attribute.
bool allowed(const std::string &name, unsigned components, std::uint64_t type, bool normalized) {
    const bool small = type == type_i8 || type == type_u8 || type == type_i16 || type == type_u16;
    const bool is_signed = type == type_i8 || type == type_i16;
    if (type == type_f32) {
        normalized = true; // floats need no division: allowed wherever normalised integers are
    }
    if (name == "POSITION") {
        return components == 3 && (small || type == type_f32);
    }
    if (name == "NORMAL") {
        return components == 3 && normalized && (is_signed || type == type_f32);
    }
    if (name == "TANGENT") {
        return components == 4 && normalized && (is_signed || type == type_f32);
    }
    if (is_set(name, "TEXCOORD_")) {
        return components == 2 && (small || type == type_f32);
    }
    if (is_set(name, "COLOR_")) {
        return (components == 3 || components == 4) &&
               (type == type_u8 || type == type_u16 || type == type_f32);
    }
    return components != 0; // custom ones are free; matrices do not fit gltf.h
}

const float *geometry_loader::attribute(std::size_t accessor_index, const std::string &name,
                                        std::uint32_t vertex_count, unsigned &components,
                                        const std::string &where) {
    const json &accessor = source_.root["accessors"][accessor_index];
    const std::uint64_t type = accessor["componentType"], count = accessor["count"];
    components = component_count(accessor);
    component_size(type, where + ", " + name);
    if (!allowed(name, components, type, accessor.value("normalized", false))) {
        throw refusal(where + ": " + name + " is " +
                      accessor["type"].get<std::string>().substr(0, 20) + " of component type " +
                      std::to_string(type) + "; " + attribute_rule);
    }
    if (count != vertex_count) {
        throw refusal(where + ": " + name + " has " + std::to_string(count) +
                      " elements, POSITION has " + std::to_string(vertex_count));
    }
    // Integer colours are only ever normalised; some exporters forget to say so.
    const std::vector<float> &floats = values(accessor_index, is_set(name, "COLOR_"));
    for (std::size_t i = 0; i < floats.size(); i++) {
        if (!std::isfinite(floats[i])) {
            const std::string line = where + ": " + name + " of vertex " +
                                     std::to_string(i / components) + " is not finite";
            if (name == "POSITION") {
                throw refusal(line);
            }
            warn_(line + ", the attribute is left out");
            return nullptr;
        }
    }
    return floats.data();
}

// Triangles of a strip and a fan in the vertex order of glTF 2.0, section 3.7.2.1: the odd ones of
// a strip swap two corners, which keeps the winding.
std::vector<std::uint32_t> unrolled(std::vector<std::uint32_t> list, unsigned mode) {
    if (mode == mode_triangles) {
        list.resize(list.size() / 3 * 3);
        return list;
    }
    std::vector<std::uint32_t> triangles;
    const std::size_t count = list.size() < 3 ? 0 : list.size() - 2;
    triangles.reserve(3 * count);
    for (std::size_t i = 0; i < count; i++) {
        const std::size_t odd = i % 2;
        if (mode == mode_strip) {
            triangles.insert(triangles.end(), {list[i], list[i + 1 + odd], list[i + 2 - odd]});
        } else {
            triangles.insert(triangles.end(), {list[i + 1], list[i + 2], list[0]});
        }
    }
    return triangles;
}

bool geometry_loader::load_primitive(const json &description, const std::string &where,
                                     girih_gltf_primitive &primitive) {
    static const char *const other_modes[] = {"points", "lines", "a line loop", "a line strip"};
    const unsigned mode = description.value("mode", unsigned{mode_triangles});
    if (mode < mode_triangles) {
        warn_(where + ": " + other_modes[mode] + ", left out (only triangles are drawn)");
        return false;
    }
    const json &attributes = description["attributes"];
    if (!attributes.contains("POSITION")) {
        warn_(where + ": no POSITION, left out");
        return false;
    }
    const std::size_t position_index = attributes["POSITION"];
    const json &positions = source_.root["accessors"][position_index];
    const json no_extensions = json::object();
    const json &extensions =
        description.contains("extensions") ? description["extensions"] : no_extensions;
    if (!positions.contains("bufferView") && !positions.contains("sparse") &&
        extensions.contains("KHR_draco_mesh_compression")) {
        throw refusal(where + ": compressed by KHR_draco_mesh_compression without fallback; " +
                      "decompress the file first: gltf-transform cp IN OUT");
    }
    const std::uint64_t count = positions["count"];
    if (count > std::numeric_limits<std::uint32_t>::max() - 1) {
        throw refusal(where + ": " + std::to_string(count) + " vertices are too many");
    }
    primitive.vertex_count = static_cast<std::uint32_t>(count);
    primitive.material = description.value("material", -1);

    std::vector<girih_gltf_attribute> kept;
    for (const auto &member : attributes.items()) {
        const std::string &name = member.key();
        const bool known = name == "POSITION" || name == "NORMAL" || name == "TANGENT" ||
                           is_set(name, "TEXCOORD_") || is_set(name, "COLOR_");
        if (is_set(name, "JOINTS_") || is_set(name, "WEIGHTS_")) {
            continue;
        }
        const json &accessor = source_.root["accessors"][member.value().get<std::size_t>()];
        if (!known && (name.empty() || name[0] != '_')) {
            warn_(where + ": unknown attribute " + name + " is left out");
            continue;
        }
        if (!known && component_count(accessor) == 0) {
            warn_(where + ": attribute " + name + " of matrices is left out");
            continue;
        }
        unsigned components = 0;
        const float *floats =
            attribute(member.value(), name, primitive.vertex_count, components, where);
        if (name == "POSITION") {
            primitive.positions = floats;
        } else if (name == "NORMAL") {
            primitive.normals = floats;
        } else if (floats != nullptr) {
            kept.push_back({model_.keep_name(name), components, floats});
        }
    }
    model_.attributes.push_back(std::move(kept));
    primitive.attributes = model_.attributes.back().data();
    primitive.attribute_count = static_cast<std::uint32_t>(model_.attributes.back().size());

    std::vector<std::uint32_t> list;
    if (description.contains("indices")) {
        list = index_list(description["indices"], primitive.vertex_count, where);
    } else {
        list.resize(primitive.vertex_count);
        for (std::uint32_t i = 0; i < primitive.vertex_count; i++) {
            list[i] = i;
        }
    }
    if (list.size() < 3 || (mode == mode_triangles && list.size() % 3 != 0)) {
        warn_(where + ": " + std::to_string(list.size()) +
              " corners are no whole number of triangles");
    }
    const std::uint64_t triangle_count = mode == mode_triangles ? list.size() / 3 : list.size();
    if (triangle_count + model_.contents.triangle_count >
        std::numeric_limits<std::uint32_t>::max() / 3) {
        throw refusal(where + ": the file has more triangles than 32 bits can index");
    }
    model_.indices.push_back(unrolled(std::move(list), mode));
    const std::vector<std::uint32_t> &triangles = model_.indices.back();
    primitive.indices = triangles.data();
    primitive.index_count = static_cast<std::uint32_t>(triangles.size());
    model_.contents.triangle_count += primitive.index_count / 3;
    return true;
}

void geometry_loader::load() {
    const std::size_t mesh_count = source_.count("meshes");
    model_.source_primitives.resize(mesh_count);
    for (std::size_t m = 0; m < mesh_count; m++) {
        const json &mesh = source_.root["meshes"][m];
        const std::string mesh_label = label(source_.root, "meshes", "mesh", m);
        std::vector<girih_gltf_primitive> primitives;
        std::size_t target_count = 0;
        for (std::size_t p = 0; p < mesh["primitives"].size(); p++) {
            const json &description = mesh["primitives"][p];
            girih_gltf_primitive primitive = {};
            if (description.contains("targets")) {
                target_count = std::max(target_count, description["targets"].size());
            }
            if (load_primitive(description, mesh_label + ", primitive " + std::to_string(p),
                               primitive)) {
                primitives.push_back(primitive);
                model_.source_primitives[m].push_back(p);
            } else {
                model_.contents.skipped_primitives++;
            }
        }
        model_.contents.morph_target_count += static_cast<std::uint32_t>(target_count);
        model_.primitives.push_back(std::move(primitives));
        const std::vector<girih_gltf_primitive> &kept = model_.primitives.back();
        std::string name = "mesh " + std::to_string(m);
        if (mesh.contains("name") && mesh["name"].is_string()) {
            name = mesh["name"];
        }
        model_.meshes.push_back(
            {model_.keep_name(name), static_cast<std::uint32_t>(kept.size()), kept.data()});
    }
    model_.contents.mesh_count = static_cast<std::uint32_t>(mesh_count);
    model_.contents.meshes = model_.meshes.data();
    model_.contents.skin_count = static_cast<std::uint32_t>(source_.count("skins"));
    model_.contents.animation_count = static_cast<std::uint32_t>(source_.count("animations"));
}

} // namespace

void load_geometry(girih_gltf_model &model, document &source, const warner &warn) {
    geometry_loader(model, source, warn).load();
}

} // namespace girih_gltf
