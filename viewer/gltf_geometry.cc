// Meshes and their primitives: glTF 2.0, section 3.7.2; KHR_mesh_quantization for integer
// positions, normals, tangents and coordinates.
#include "gltf_model.hh"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace girih_gltf {
namespace {

enum primitive_mode : unsigned { mode_triangles = 4, mode_strip = 5, mode_fan = 6 };

class geometry_loader {
public:
    geometry_loader(girih_gltf_model &model, document &source, const warner &warn)
        : model_(model), source_(source), warn_(warn) {}

    void load();

  private:
    std::vector<std::uint32_t> index_list(std::size_t accessor_index, std::uint32_t vertex_count,
                                          const std::string &where);
    const float *attribute(std::size_t accessor_index, const std::string &name, bool is_delta,
                           std::uint32_t vertex_count, unsigned &components,
                           const std::string &where);
    void load_influences(const json &attributes, const std::string &where,
                         girih_gltf_primitive &primitive);
    void load_targets(const json &description, const std::string &where,
                      girih_gltf_primitive &primitive);
    void load_target_weights(const json &mesh, const std::string &where, girih_gltf_mesh &loaded);
    bool load_primitive(const json &description, const std::string &where,
                        girih_gltf_primitive &primitive);

    girih_gltf_model &model_;
    document &source_;
    const warner &warn_;
};

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
        const std::vector<float> &exact = accessor_values(model_, source_, accessor_index, false);
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

// Matrices do not fit gltf.h.
bool is_vector(unsigned components) {
    return components >= 1 && components <= 4;
}

const char *const attribute_rule = "glTF does not allow this type for it";

// Whether glTF 2.0, sections 3.7.2.1 and 3.7.2.2, or KHR_mesh_quantization allows the type for the
// attribute, or for what a morph target adds to it.
bool allowed(const std::string &name, bool is_delta, unsigned components, std::uint64_t type,
             bool normalized) {
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
        return components == (is_delta ? 3 : 4) && normalized && (is_signed || type == type_f32);
    }
    if (is_set(name, "TEXCOORD_")) {
        return components == 2 && (small || type == type_f32);
    }
    if (is_set(name, "COLOR_")) {
        return (components == 3 || components == 4) &&
               (type == type_u8 || type == type_u16 || type == type_f32);
    }
    if (is_set(name, "JOINTS_")) {
        return components == 4 && (type == type_u8 || type == type_u16);
    }
    if (is_set(name, "WEIGHTS_")) {
        return components == 4 && (type == type_u8 || type == type_u16 || type == type_f32);
    }
    return is_vector(components); // custom ones are free
}

const float *geometry_loader::attribute(std::size_t accessor_index, const std::string &name,
                                        bool is_delta, std::uint32_t vertex_count,
                                        unsigned &components, const std::string &where) {
    const json &accessor = source_.root["accessors"][accessor_index];
    const std::uint64_t type = accessor["componentType"], count = accessor["count"];
    components = component_count(accessor);
    component_size(type, where + ", " + name);
    if (!allowed(name, is_delta, components, type, accessor.value("normalized", false))) {
        throw refusal(where + ": " + name + " is " +
                      accessor["type"].get<std::string>().substr(0, 20) + " of component type " +
                      std::to_string(type) + "; " + attribute_rule);
    }
    if (count != vertex_count) {
        throw refusal(where + ": " + name + " has " + std::to_string(count) +
                      " elements, POSITION has " + std::to_string(vertex_count));
    }
    // Integer colours and weights are only ever normalised; some exporters forget to say so.
    const std::vector<float> &floats = accessor_values(
        model_, source_, accessor_index, is_set(name, "COLOR_") || is_set(name, "WEIGHTS_"));
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

// The sets of joints and weights, one behind the other at each vertex.
void geometry_loader::load_influences(const json &attributes, const std::string &where,
                                      girih_gltf_primitive &primitive) {
    unsigned set_count = 0;
    for (const auto &member : attributes.items()) {
        set_count += is_set(member.key(), "JOINTS_") || is_set(member.key(), "WEIGHTS_");
    }
    set_count = (set_count + 1) / 2;
    if (set_count == 0) {
        return;
    }
    const std::size_t vertices = primitive.vertex_count, stride = std::size_t{4} * set_count;
    model_.indices.emplace_back(vertices * stride);
    model_.floats.emplace_back(vertices * stride);
    std::vector<std::uint32_t> &joints = model_.indices.back();
    std::vector<float> &weights = model_.floats.back();
    for (unsigned set = 0; set < set_count; set++) {
        const float *from[2];
        for (unsigned which = 0; which < 2; which++) {
            const std::string name = (which == 0 ? "JOINTS_" : "WEIGHTS_") + std::to_string(set);
            unsigned components = 0;
            if (!attributes.contains(name)) {
                throw refusal(where + ": " + name + " is missing, the sets of JOINTS_n and " +
                              "WEIGHTS_n must be pairs, counted from 0");
            }
            from[which] =
                attribute(attributes[name], name, false, primitive.vertex_count, components, where);
        }
        for (std::size_t i = 0; i < 4 * vertices; i++) {
            const std::size_t to = i / 4 * stride + std::size_t{4} * set + i % 4;
            if (from[1] == nullptr || from[1][i] < 0.0f) {
                throw refusal(where + ": WEIGHTS_" + std::to_string(set) + " of vertex " +
                              std::to_string(i / 4) + " is not a number of at least 0");
            }
            // A weight of 0 may name any joint; 0 is what glTF wants there.
            joints[to] = from[1][i] > 0.0f ? static_cast<std::uint32_t>(from[0][i]) : 0;
            weights[to] = from[1][i];
        }
    }
    primitive.influence_count = 4 * set_count;
    primitive.joints = joints.data();
    primitive.weights = weights.data();
}

void geometry_loader::load_targets(const json &description, const std::string &where,
                                   girih_gltf_primitive &primitive) {
    std::vector<girih_gltf_morph_target> targets;
    for (const json &from : description.value("targets", json::array())) {
        const std::string target_where = where + ", morph target " + std::to_string(targets.size());
        girih_gltf_morph_target target = {};
        std::vector<girih_gltf_attribute> kept;
        for (const auto &member : from.items()) {
            const std::string &name = member.key();
            const bool is_base = name == "POSITION" || (name == "NORMAL" && primitive.normals);
            const girih_gltf_attribute *end = primitive.attributes + primitive.attribute_count;
            if (!is_base && std::none_of(primitive.attributes, end,
                                         [&](const auto &base) { return name == base.name; })) {
                continue; // glTF forbids what the primitive does not have; other viewers let it be
            }
            unsigned components = 0;
            const float *deltas = attribute(member.value(), name, true, primitive.vertex_count,
                                            components, target_where);
            if (name == "POSITION") {
                target.positions = deltas;
            } else if (name == "NORMAL") {
                target.normals = deltas;
            } else if (deltas != nullptr) {
                kept.push_back({model_.keep_name(name), components, deltas});
            }
        }
        model_.attributes.push_back(std::move(kept));
        target.attributes = model_.attributes.back().data();
        target.attribute_count = static_cast<std::uint32_t>(model_.attributes.back().size());
        targets.push_back(target);
    }
    model_.targets.push_back(std::move(targets));
    primitive.targets = model_.targets.back().data();
}

void geometry_loader::load_target_weights(const json &mesh, const std::string &where,
                                          girih_gltf_mesh &loaded) {
    std::vector<float> weights;
    for (const double weight : mesh.value("weights", std::vector<double>(loaded.target_count))) {
        weights.push_back(finite(weight));
    }
    if (weights.size() != loaded.target_count) {
        throw refusal(where + ": has " + std::to_string(weights.size()) + " weights, but " +
                      std::to_string(loaded.target_count) + " morph targets");
    }
    model_.floats.push_back(std::move(weights));
    loaded.weights = model_.floats.back().data();
    // By convention of the exporters; extras may be anything.
    const json extras = mesh.value("extras", json());
    const json names = extras.is_object() ? extras.value("targetNames", json()) : json();
    if (names.is_array() && names.size() == loaded.target_count && loaded.target_count > 0 &&
        std::all_of(names.begin(), names.end(),
                    [](const json &name) { return name.is_string(); })) {
        std::vector<const char *> kept;
        for (const json &name : names) {
            kept.push_back(model_.keep_name(name));
        }
        model_.name_lists.push_back(std::move(kept));
        loaded.target_names = model_.name_lists.back().data();
    }
}

bool geometry_loader::load_primitive(const json &description, const std::string &where,
                                     girih_gltf_primitive &primitive) {
    static const char *const other_modes[] = {"points", "lines", "a line loop", "a line strip"};
    const unsigned mode = description.value("mode", unsigned{mode_triangles});
    if (mode < mode_triangles) {
        warn_(where + ": " + other_modes[mode] + ", neither drawn nor refined (only triangles are)");
        return false;
    }
    const json &attributes = description["attributes"];
    if (!attributes.contains("POSITION")) {
        warn_(where + ": no POSITION, neither drawn nor refined");
        return false;
    }
    const std::size_t position_index = attributes["POSITION"];
    const json &positions = source_.root["accessors"][position_index];
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
            continue; // load_influences
        }
        const json &accessor = source_.root["accessors"][member.value().get<std::size_t>()];
        if (!known && (name.empty() || name[0] != '_')) {
            warn_(where + ": unknown attribute " + name + " is left out");
            continue;
        }
        if (!known && !is_vector(component_count(accessor))) {
            warn_(where + ": attribute " + name + " of matrices is left out");
            continue;
        }
        unsigned components = 0;
        const float *floats =
            attribute(member.value(), name, false, primitive.vertex_count, components, where);
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

    load_influences(attributes, where, primitive);
    load_targets(description, where, primitive);

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
            const std::string where = mesh_label + ", primitive " + std::to_string(p);
            girih_gltf_primitive primitive = {};
            const std::size_t count = description.value("targets", json::array()).size();
            if (!load_primitive(description, where, primitive)) {
                model_.contents.skipped_primitives++;
            } else if (!primitives.empty() && count != target_count) {
                throw refusal(where + ": has " + std::to_string(count) +
                              " morph targets, a primitive before it has " +
                              std::to_string(target_count));
            } else {
                primitives.push_back(primitive);
                model_.source_primitives[m].push_back(p);
                target_count = count;
            }
            target_count = primitives.empty() ? count : target_count;
        }
        model_.primitives.push_back(std::move(primitives));
        const std::vector<girih_gltf_primitive> &kept = model_.primitives.back();
        girih_gltf_mesh loaded = {};
        loaded.name = model_.keep_name(name_or_number(mesh, "mesh", m));
        loaded.primitive_count = static_cast<std::uint32_t>(kept.size());
        loaded.primitives = kept.data();
        loaded.target_count = static_cast<std::uint32_t>(target_count);
        load_target_weights(mesh, mesh_label, loaded);
        model_.contents.morph_target_count += loaded.target_count;
        model_.meshes.push_back(loaded);
    }
    model_.contents.mesh_count = static_cast<std::uint32_t>(mesh_count);
    model_.contents.meshes = model_.meshes.data();
}

} // namespace

void load_geometry(girih_gltf_model &model, document &source, const warner &warn) {
    geometry_loader(model, source, warn).load();
}

} // namespace girih_gltf
