// Writes a model with new geometry as a GLB (glTF 2.0, section 4). The document is the source's
// own, so that materials, nodes, animations, names, cameras and extras stay as they are; only what
// describes bytes is made anew. The binary chunk is streamed from the caller's arrays in a second
// pass.
#include "gltf_model.hh"
#include "output_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <set>

namespace girih_gltf {
namespace {

constexpr std::uint64_t greatest_file = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t greatest_short_vertex_count = 65535; // index 65535 would be the restart value
constexpr unsigned target_vertices = 34962, target_indices = 34963;

// Extensions that describe the source's bytes or vertices: they do not hold for what is written.
const std::set<std::string> dropped_extensions = {
    "EXT_mesh_features", "EXT_instance_features",    "EXT_structural_metadata",
    "EXT_mesh_manifold", "CESIUM_primitive_outline", "EXT_mesh_primitive_edge_visibility"};

// Of the extensions that a primitive can have, only these are known not to describe its vertices.
const std::set<std::string> kept_primitive_extensions = {"KHR_materials_variants",
                                                         "KHR_xmp_json_ld"};

// A stretch of the binary chunk; streamed in order, each beginning at a multiple of 4.
struct piece {
    enum kind {
        floats,
        normals,
        tangents,
        short_indices,
        indices,
        joints,
        short_joints,
        weights,
        file
    } type;
    const void *data;
    std::size_t count;      // floats, normals (of 3 floats), tangents (of 4), indices, joints and
                            // weights (of 4), or bytes
    std::size_t stride = 0; // joints, weights: from one to the next, in elements
};

std::uint64_t piece_size(const piece &part) {
    static const std::uint64_t sizes[] = {4, 12, 16, 2, 4, 4, 8, 16, 1};
    return sizes[part.type] * part.count;
}

std::uint64_t padded(std::uint64_t size) {
    return (size + 3) / 4 * 4;
}

const char *mime_type(const bytes &file) {
    if (file.size() > 8 && std::memcmp(file.data(), "\x89PNG\r\n\x1a\n", 8) == 0) {
        return "image/png";
    }
    if (file.size() > 3 && std::memcmp(file.data(), "\xff\xd8\xff", 3) == 0) {
        return "image/jpeg";
    }
    if (file.size() > 12 && std::memcmp(file.data(), "RIFF", 4) == 0 &&
        std::memcmp(file.data() + 8, "WEBP", 4) == 0) {
        return "image/webp";
    }
    if (file.size() > 12 && std::memcmp(file.data(), "\xabKTX 20\xbb\r\n\x1a\n", 12) == 0) {
        return "image/ktx2";
    }
    return nullptr;
}

// Whether a member anywhere below names bytes by number, which are other bytes in the new file.
bool refers_to_bytes(const json &value) {
    if (value.is_object()) {
        for (const auto &member : value.items()) {
            std::string name = member.key();
            std::transform(name.begin(), name.end(), name.begin(), [](char c) {
                return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
            });
            if (name.find("bufferview") != std::string::npos ||
                name.find("accessor") != std::string::npos) {
                return true;
            }
        }
    }
    return value.is_structured() &&
           std::any_of(value.begin(), value.end(),
                       [](const json &element) { return refers_to_bytes(element); });
}

// Erases the extensions for which drop(name, value) holds; their names go into `dropped`.
template <typename Drop>
void drop_extensions(json &owner, std::set<std::string> &dropped, Drop drop) {
    const auto extensions = owner.find("extensions");
    if (extensions == owner.end() || !extensions->is_object()) {
        return;
    }
    for (auto extension = extensions->begin(); extension != extensions->end();) {
        if (drop(extension.key(), *extension)) {
            dropped.insert(extension.key());
            extension = extensions->erase(extension);
        } else {
            ++extension;
        }
    }
    if (extensions->empty()) {
        owner.erase("extensions");
    }
}

void drop_all_extensions(json &value, std::set<std::string> &dropped) {
    if (value.is_object()) {
        drop_extensions(value, dropped, [](const std::string &name, const json &extension) {
            return dropped_extensions.count(name) != 0 || refers_to_bytes(extension);
        });
    }
    if (value.is_structured()) {
        for (auto member = value.begin(); member != value.end(); ++member) {
            if (!value.is_object() || member.key() != "extras") {
                drop_all_extensions(*member, dropped);
            }
        }
    }
}

void collect_extensions(const json &value, std::set<std::string> &names) {
    if (value.is_object()) {
        const auto extensions = value.find("extensions");
        if (extensions != value.end() && extensions->is_object()) {
            for (const auto &extension : extensions->items()) {
                names.insert(extension.key());
            }
        }
    }
    if (value.is_structured()) {
        for (auto member = value.begin(); member != value.end(); ++member) {
            if (!value.is_object() || member.key() != "extras") {
                collect_extensions(*member, names);
            }
        }
    }
}

// The elements of an array, if it is there.
template <typename Work> void for_each(json &owner, const char *array, Work work) {
    const auto found = owner.find(array);
    if (found != owner.end()) {
        std::for_each(found->begin(), found->end(), work);
    }
}

class writer {
  public:
    writer(const girih_gltf_model &model, const girih_gltf_refined_primitive *const *refined,
           const warner &warn)
        : model_(model), source_(*model.source), refined_(refined), warn_(warn),
          root_(model.source->root) {
    }

    void write(const char *path);

  private:
    std::size_t add_view(const piece &part, unsigned target);
    std::size_t add_accessor(json accessor);
    std::size_t add_vertices(const piece &part, const char *type, unsigned component_type,
                             std::uint32_t vertex_count, const json &source);
    std::size_t add_floats(const float *values, std::uint32_t vertex_count, unsigned components,
                           const json &source);
    std::size_t add_points(const float *values, std::uint32_t vertex_count, const json &source,
                           const std::string &where);
    void add_influences(const girih_gltf_primitive &source,
                        const girih_gltf_refined_primitive &refined, const json &source_attributes,
                        json &attributes);
    json target(const girih_gltf_morph_target &source, const girih_gltf_refined_target &refined,
                std::uint32_t vertex_count, const json &description, const std::string &where);
    json primitive(std::size_t mesh_index, std::size_t primitive_index);
    std::size_t copy_accessor(std::size_t index, unsigned target);
    void copy_index(json &owner, const char *member, unsigned target);
    void copy_members(json &owner, unsigned target);
    json copied_primitive(const json &source);
    void describe_meshes();
    void describe_motion();
    void describe_images();
    void describe_rest();

    const girih_gltf_model &model_;
    document &source_;
    const girih_gltf_refined_primitive *const *refined_;
    const warner &warn_;
    json root_;
    json accessors_ = json::array(), views_ = json::array();
    std::vector<piece> pieces_;
    std::uint64_t binary_size_ = 0;
    std::set<std::string> dropped_; // extensions
    std::deque<bytes> copies_;
    std::map<std::pair<std::size_t, unsigned>, std::size_t> copied_; // accessor and target: copy
    bool has_copied_primitives_ = false;
};

std::size_t writer::add_view(const piece &part, unsigned target) {
    const std::uint64_t size = piece_size(part);
    json view = {{"buffer", 0}, {"byteOffset", binary_size_}, {"byteLength", size}};
    if (target != 0) {
        view["target"] = target;
    }
    views_.push_back(std::move(view));
    pieces_.push_back(part);
    binary_size_ += padded(size);
    return views_.size() - 1;
}

std::size_t writer::add_accessor(json accessor) {
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
}

// source: the accessor that this one is made from, for its name and extras.
std::size_t writer::add_vertices(const piece &part, const char *type, unsigned component_type,
                                 std::uint32_t vertex_count, const json &source) {
    json accessor = {{"bufferView", add_view(part, target_vertices)},
                     {"componentType", component_type},
                     {"count", vertex_count},
                     {"type", type}};
    for (const char *member : {"name", "extras"}) {
        if (source.contains(member)) {
            accessor[member] = source[member];
        }
    }
    return add_accessor(std::move(accessor));
}

std::size_t writer::add_floats(const float *values, std::uint32_t vertex_count, unsigned components,
                               const json &source) {
    static const char *const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    return add_vertices({piece::floats, values, std::size_t{vertex_count} * components},
                        types[components - 1], type_f32, vertex_count, source);
}

// Positions or their deltas: glTF wants their bounds.
std::size_t writer::add_points(const float *values, std::uint32_t vertex_count, const json &source,
                               const std::string &where) {
    float low[3], high[3];
    for (std::size_t i = 0; i < std::size_t{3} * vertex_count; i++) {
        const float value = values[i];
        if (!std::isfinite(value)) {
            throw refusal(where + ": a position is not finite");
        }
        low[i % 3] = i < 3 ? value : std::min(low[i % 3], value);
        high[i % 3] = i < 3 ? value : std::max(high[i % 3], value);
    }
    const std::size_t accessor = add_floats(values, vertex_count, 3, source);
    accessors_[accessor]["min"] = json(low);
    accessors_[accessor]["max"] = json(high);
    return accessor;
}

void writer::add_influences(const girih_gltf_primitive &source,
                            const girih_gltf_refined_primitive &refined,
                            const json &source_attributes, json &attributes) {
    const std::uint32_t stride = source.influence_count, count = refined.vertex_count;
    const std::uint32_t *end = refined.joints + std::size_t{count} * stride;
    const bool is_short = std::any_of(refined.joints, end, [](auto joint) { return joint > 255; });
    for (std::uint32_t set = 0; set < stride / 4; set++) {
        const std::string joints = "JOINTS_" + std::to_string(set),
                          weights = "WEIGHTS_" + std::to_string(set);
        attributes[joints] =
            add_vertices({is_short ? piece::short_joints : piece::joints,
                          refined.joints + std::size_t{4} * set, count, stride},
                         "VEC4", is_short ? type_u16 : type_u8, count, source_attributes[joints]);
        attributes[weights] =
            add_vertices({piece::weights, refined.weights + std::size_t{4} * set, count, stride},
                         "VEC4", type_f32, count, source_attributes[weights]);
    }
}

json writer::target(const girih_gltf_morph_target &source, const girih_gltf_refined_target &refined,
                    std::uint32_t vertex_count, const json &description, const std::string &where) {
    json attributes = json::object();
    const auto accessor = [&](const char *name) {
        const auto index = description.find(name);
        return index == description.end() ? json::object()
                                          : source_.root["accessors"][index->get<std::size_t>()];
    };
    if (refined.positions != nullptr) {
        attributes["POSITION"] =
            add_points(refined.positions, vertex_count, accessor("POSITION"), where);
    }
    if (refined.normals != nullptr) {
        attributes["NORMAL"] = add_floats(refined.normals, vertex_count, 3, accessor("NORMAL"));
    }
    for (std::uint32_t a = 0; a < source.attribute_count; a++) {
        const girih_gltf_attribute &attribute = source.attributes[a];
        attributes[attribute.name] = add_floats(refined.attributes[a], vertex_count,
                                                attribute.components, accessor(attribute.name));
    }
    if (attributes.empty()) { // glTF wants one: all zeros, which take no bytes
        const json zero = {0.0, 0.0, 0.0};
        attributes["POSITION"] = add_accessor({{"componentType", type_f32},
                                               {"count", vertex_count},
                                               {"type", "VEC3"},
                                               {"min", zero},
                                               {"max", zero}});
    }
    return attributes;
}

json writer::primitive(std::size_t mesh_index, std::size_t primitive_index) {
    const girih_gltf_mesh &mesh = model_.meshes[mesh_index];
    const girih_gltf_primitive &source = mesh.primitives[primitive_index];
    const girih_gltf_refined_primitive &refined = refined_[mesh_index][primitive_index];
    const std::string where =
        std::string("mesh '") + mesh.name + "', primitive " + std::to_string(primitive_index);
    json description = root_["meshes"][mesh_index]["primitives"]
                            [model_.source_primitives[mesh_index][primitive_index]];
    drop_extensions(description, dropped_, [](const std::string &name, const json &) {
        return kept_primitive_extensions.count(name) == 0;
    });
    description.erase("mode");
    json from = json::object(); // the accessors that the attributes had
    for (const auto &member : description["attributes"].items()) {
        from[member.key()] = source_.root["accessors"][member.value().get<std::size_t>()];
    }
    json &attributes = description["attributes"] = json::object();

    for (std::size_t i = 0; i < refined.index_count; i++) {
        if (refined.indices[i] >= refined.vertex_count) {
            throw refusal(where + ": an index is out of range");
        }
    }
    const std::uint32_t count = refined.vertex_count;
    attributes["POSITION"] = add_points(refined.positions, count, from["POSITION"], where);
    if (refined.normals != nullptr) {
        attributes["NORMAL"] = add_vertices({piece::normals, refined.normals, count}, "VEC3",
                                            type_f32, count, from["NORMAL"]);
    }
    for (std::uint32_t a = 0; a < source.attribute_count; a++) {
        const girih_gltf_attribute &attribute = source.attributes[a];
        if (std::strcmp(attribute.name, "TANGENT") == 0) {
            attributes["TANGENT"] = add_vertices({piece::tangents, refined.attributes[a], count},
                                                 "VEC4", type_f32, count, from["TANGENT"]);
        } else {
            attributes[attribute.name] = add_floats(refined.attributes[a], count,
                                                    attribute.components, from[attribute.name]);
        }
    }
    if (source.influence_count > 0) {
        add_influences(source, refined, from, attributes);
    }
    for (std::uint32_t t = 0; t < mesh.target_count; t++) {
        json &slot = description["targets"][t];
        slot = target(source.targets[t], refined.targets[t], count, slot,
                      where + ", morph target " + std::to_string(t));
    }
    const bool is_short = count <= greatest_short_vertex_count;
    const std::size_t view = add_view(
        {is_short ? piece::short_indices : piece::indices, refined.indices, refined.index_count},
        target_indices);
    description["indices"] = add_accessor({{"bufferView", view},
                                           {"componentType", is_short ? type_u16 : type_u32},
                                           {"count", refined.index_count},
                                           {"type", "SCALAR"}});
    return description;
}

// --- What stays as it is ---

std::size_t writer::copy_accessor(std::size_t index, unsigned target) {
    const auto known = copied_.find({index, target});
    if (known != copied_.end()) {
        return known->second;
    }
    json accessor = source_.root["accessors"][index];
    const bool has_data = accessor.contains("bufferView") || accessor.contains("sparse");
    for (const char *member : {"bufferView", "byteOffset", "sparse", "extensions"}) {
        accessor.erase(member);
    }
    if (has_data) {
        // Elements of vertices stand at multiples of 4 (glTF 2.0, section 3.6.2.4).
        const std::size_t alignment = target == target_vertices ? 4 : 1;
        copies_.push_back(accessor_bytes(source_, index, alignment));
        const bytes &data = copies_.back();
        accessor["bufferView"] = add_view({piece::file, data.data(), data.size()}, target);
        if (target == target_vertices) {
            views_.back()["byteStride"] =
                data.size() / static_cast<std::size_t>(accessor["count"].get<std::uint64_t>());
        }
    }
    return copied_[{index, target}] = add_accessor(std::move(accessor));
}

void writer::copy_index(json &owner, const char *member, unsigned target) {
    const auto index = owner.find(member);
    if (index != owner.end()) {
        *index = copy_accessor(index->get<std::size_t>(), target);
    }
}

void writer::copy_members(json &owner, unsigned target) {
    for (json &index : owner) {
        index = copy_accessor(index.get<std::size_t>(), target);
    }
}

json writer::copied_primitive(const json &source) {
    json description = source;
    copy_members(description["attributes"], target_vertices);
    copy_index(description, "indices", target_indices);
    for_each(description, "targets", [&](json &target) { copy_members(target, target_vertices); });
    has_copied_primitives_ = true;
    return description;
}

void writer::describe_meshes() {
    for (std::size_t m = 0; m < model_.meshes.size(); m++) {
        const std::vector<std::size_t> &places = model_.source_primitives[m];
        json primitives = json::array();
        for (std::size_t i = 0; i < root_["meshes"][m]["primitives"].size(); i++) {
            const auto found = std::find(places.begin(), places.end(), i);
            const auto p = static_cast<std::size_t>(found - places.begin());
            // glTF wants at least one triangle in a primitive.
            const bool is_refined = found != places.end() && refined_[m][p].index_count >= 3;
            primitives.push_back(is_refined
                                     ? primitive(m, p)
                                     : copied_primitive(root_["meshes"][m]["primitives"][i]));
        }
        root_["meshes"][m]["primitives"] = std::move(primitives);
    }
}

// Joints, keys of animations and instances: accessors outside of meshes.
void writer::describe_motion() {
    for_each(root_, "skins", [&](json &skin) { copy_index(skin, "inverseBindMatrices", 0); });
    for_each(root_, "animations", [&](json &animation) {
        for_each(animation, "samplers", [&](json &sampler) {
            copy_index(sampler, "input", 0);
            copy_index(sampler, "output", 0);
        });
    });
    for_each(root_, "nodes", [&](json &node) {
        if (node.contains("/extensions/EXT_mesh_gpu_instancing/attributes"_json_pointer)) {
            copy_members(node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"], 0);
        }
    });
}

void writer::describe_images() {
    for (std::size_t i = 0; i < model_.image_files.size(); i++) {
        const bytes &file = model_.image_files[i];
        json &image = root_["images"][i];
        if (file.empty()) {
            continue; // it could not be read: its URI stays
        }
        const char *type = mime_type(file);
        if (type != nullptr) {
            image["mimeType"] = type;
        } else if (!image.contains("mimeType")) {
            image["mimeType"] = "application/octet-stream";
        }
        image.erase("uri");
        image["bufferView"] = add_view({piece::file, file.data(), file.size()}, 0);
    }
}

void writer::describe_rest() {
    root_["asset"]["generator"] = "girih";
    const std::set<std::string> used = root_.value("extensionsUsed", std::set<std::string>());
    root_["accessors"] = std::move(accessors_);
    root_["bufferViews"] = std::move(views_);
    root_["buffers"] = json::array();
    if (binary_size_ > 0) {
        root_["buffers"].push_back({{"byteLength", binary_size_}});
    }
    std::set<std::string> occurring;
    collect_extensions(root_, occurring);
    if (has_copied_primitives_ && used.count("KHR_mesh_quantization") != 0) {
        occurring.insert("KHR_mesh_quantization"); // which leaves no other trace
    }
    json required = json::array();
    for (const json &name : root_.value("extensionsRequired", json::array())) {
        if (occurring.count(name.get<std::string>()) != 0) {
            required.push_back(name);
        }
    }
    root_["extensionsUsed"] = std::vector<std::string>(occurring.begin(), occurring.end());
    root_["extensionsRequired"] = std::move(required);
    for (auto part = root_.begin(); part != root_.end();) {
        part = part->is_array() && part->empty() ? root_.erase(part)
                                                 : std::next(part); // glTF wants none
    }
}

void append_u32(std::string &to, std::uint64_t value) {
    for (unsigned i = 0; i < 4; i++) {
        to.push_back(static_cast<char>(value >> (8 * i) & 0xff));
    }
}

// glTF 2.0, section 3.7.2.1, wants normals and tangents of length 1 and a handedness of 1 or -1.
// What is near enough stays as it is, bit for bit; what has no direction gets one.
void unit_direction(const float *from, float *to, unsigned components) {
    constexpr double tolerance = 1e-4; // of the squared length; far below any validator's
    const double square =
        double{from[0]} * from[0] + double{from[1]} * from[1] + double{from[2]} * from[2];
    const bool usable = std::isfinite(square) && square > 0.0;
    const double length = std::fabs(square - 1.0) <= tolerance ? 1.0 : std::sqrt(square);
    for (unsigned c = 0; c < 3; c++) {
        to[c] = usable ? static_cast<float>(from[c] / length) : c == 0 ? 1.0f : 0.0f;
    }
    if (components == 4) {
        to[3] = from[3] < 0.0f ? -1.0f : 1.0f;
    }
}

// Four elements at each vertex, out of the `stride` that it has.
template <typename To, typename From> void stream_sets(const piece &part, std::FILE *stream) {
    constexpr std::size_t batch = 4096;
    To converted[4 * batch];
    const From *from = static_cast<const From *>(part.data);
    for (std::size_t first = 0; first < part.count; first += batch) {
        const std::size_t count = std::min(batch, part.count - first);
        for (std::size_t i = 0; i < 4 * count; i++) {
            converted[i] = static_cast<To>(from[(first + i / 4) * part.stride + i % 4]);
        }
        std::fwrite(converted, 4 * sizeof(To), count, stream);
    }
}

void stream_piece(const piece &part, std::FILE *stream) {
    constexpr std::size_t batch = 4096;
    if (part.type == piece::normals || part.type == piece::tangents) {
        const unsigned components = part.type == piece::normals ? 3 : 4;
        float converted[4 * batch];
        const float *from = static_cast<const float *>(part.data);
        for (std::size_t first = 0; first < part.count; first += batch) {
            const std::size_t count = std::min(batch, part.count - first);
            for (std::size_t i = 0; i < count; i++) {
                unit_direction(from + components * (first + i), converted + components * i,
                               components);
            }
            std::fwrite(converted, sizeof(float) * components, count, stream);
        }
    } else if (part.type == piece::short_indices) {
        std::uint16_t converted[batch];
        const std::uint32_t *from = static_cast<const std::uint32_t *>(part.data);
        for (std::size_t first = 0; first < part.count; first += batch) {
            const std::size_t count = std::min(batch, part.count - first);
            for (std::size_t i = 0; i < count; i++) {
                converted[i] = static_cast<std::uint16_t>(from[first + i]);
            }
            std::fwrite(converted, 2, count, stream);
        }
    } else if (part.type == piece::joints) {
        stream_sets<std::uint8_t, std::uint32_t>(part, stream);
    } else if (part.type == piece::short_joints) {
        stream_sets<std::uint16_t, std::uint32_t>(part, stream);
    } else if (part.type == piece::weights) {
        stream_sets<float, float>(part, stream);
    } else {
        std::fwrite(part.data, 1, static_cast<std::size_t>(piece_size(part)), stream);
    }
    const std::uint64_t size = piece_size(part);
    std::fwrite("\0\0\0", 1, static_cast<std::size_t>(padded(size) - size), stream);
}

// Messages of girih_output_file begin with the path, and so will what a refusal becomes.
std::string without_path(const std::string &message, const std::string &path) {
    const std::size_t prefix = path.size() + 2;
    return message.size() > prefix ? message.substr(prefix) : "cannot write";
}

void writer::write(const char *path) {
    for (const char *part : {"accessors", "bufferViews", "buffers"}) {
        root_.erase(part); // new ones take their place
    }
    describe_meshes();
    describe_motion();
    describe_images();
    drop_all_extensions(root_, dropped_);
    describe_rest();
    for (const std::string &name : dropped_) {
        warn_("extension " + name + " is left out: it may describe vertices that are new");
    }

    std::string text = root_.dump();
    text.append(static_cast<std::size_t>(padded(text.size()) - text.size()), ' ');
    const std::uint64_t size = 12 + 8 + text.size() + (binary_size_ > 0 ? 8 + binary_size_ : 0);
    if (size > greatest_file) {
        throw refusal("the result would have " + std::to_string(size) +
                      " bytes, a GLB holds 4294967295 at most; ask for fewer triangles");
    }
    std::string header = "glTF";
    append_u32(header, 2);
    append_u32(header, size);
    append_u32(header, text.size());
    header += "JSON";

    char message[512];
    girih_output_file file;
    if (!girih_output_open(&file, path, message, sizeof message)) {
        throw refusal(without_path(message, path));
    }
    const std::string target = file.target;
    std::fwrite(header.data(), 1, header.size(), file.stream);
    std::fwrite(text.data(), 1, text.size(), file.stream);
    if (binary_size_ > 0) {
        std::string binary_header;
        append_u32(binary_header, binary_size_);
        binary_header.append("BIN\0", 4);
        std::fwrite(binary_header.data(), 1, binary_header.size(), file.stream);
        for (const piece &part : pieces_) {
            if (std::ferror(file.stream) != 0) {
                break; // girih_output_commit reports it
            }
            stream_piece(part, file.stream);
        }
    }
    if (!girih_output_commit(&file, message, sizeof message)) {
        throw refusal(without_path(message, target));
    }
}

} // namespace

void write_model(const girih_gltf_model &model, const girih_gltf_refined_primitive *const *refined,
                 const char *path, const warner &warn) {
    writer(model, refined, warn).write(path);
}

} // namespace girih_gltf
