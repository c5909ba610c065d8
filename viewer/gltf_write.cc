// Writes a model with new geometry as a GLB (glTF 2.0, section 4). The document is the source's
// own, so that materials, nodes, names, cameras and extras stay as they are; only what describes
// bytes is made anew. The binary chunk is streamed from the caller's arrays in a second pass.
#include "gltf_model.hh"
#include "output_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <set>

namespace girih_gltf {
namespace {

constexpr std::uint64_t greatest_file = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t greatest_short_vertex_count = 65535; // index 65535 would be the restart value
constexpr unsigned target_vertices = 34962, target_indices = 34963;

// Extensions that describe the source's bytes, its compression or its animation: none of them holds
// for the geometry that is written.
const std::set<std::string> dropped_extensions = {
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
    "KHR_mesh_quantization",      "KHR_animation_pointer",   "EXT_mesh_gpu_instancing",
    "EXT_mesh_features",          "EXT_instance_features",   "EXT_structural_metadata",
    "EXT_mesh_manifold",          "CESIUM_primitive_outline"};

// A stretch of the binary chunk; streamed in order, each beginning at a multiple of 4.
struct piece {
    enum kind { floats, normals, tangents, short_indices, indices, file } type;
    const void *data;
    std::size_t count; // floats, normals (of 3 floats), tangents (of 4), indices or bytes
};

std::uint64_t piece_size(const piece &part) {
    static const std::uint64_t sizes[] = {4, 12, 16, 2, 4, 1};
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

void drop_extensions(json &owner) {
    const auto extensions = owner.find("extensions");
    if (extensions == owner.end() || !extensions->is_object()) {
        return;
    }
    for (auto extension = extensions->begin(); extension != extensions->end();) {
        const bool drop =
            dropped_extensions.count(extension.key()) != 0 || refers_to_bytes(*extension);
        extension = drop ? extensions->erase(extension) : std::next(extension);
    }
    if (extensions->empty()) {
        owner.erase("extensions");
    }
}

void drop_all_extensions(json &value) {
    if (value.is_object()) {
        drop_extensions(value);
    }
    if (value.is_structured()) {
        for (auto member = value.begin(); member != value.end(); ++member) {
            if (!value.is_object() || member.key() != "extras") {
                drop_all_extensions(*member);
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

class writer {
public:
    writer(const girih_gltf_model &model, const girih_gltf_refined_primitive *const *refined)
        : model_(model), refined_(refined), root_(model.root) {}

    void write(const char *path);

private:
    std::size_t add_view(const piece &part, unsigned target);
    std::size_t add_accessor(json accessor);
    std::size_t add_floats(const float *values, std::uint32_t vertex_count, unsigned components);
    std::size_t add_directions(piece::kind type, const float *values, std::uint32_t vertex_count);
    json primitive(std::size_t mesh_index, std::size_t primitive_index);
    void describe_meshes();
    void describe_images();
    void describe_rest();

    const girih_gltf_model &model_;
    const girih_gltf_refined_primitive *const *refined_;
    json root_;
    json accessors_ = json::array(), views_ = json::array();
    std::vector<piece> pieces_;
    std::uint64_t binary_size_ = 0;
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

std::size_t writer::add_floats(const float *values, std::uint32_t vertex_count,
                               unsigned components) {
    static const char *const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const std::size_t view =
        add_view({piece::floats, values, std::size_t{vertex_count} * components}, target_vertices);
    return add_accessor({{"bufferView", view},
                         {"componentType", type_f32},
                         {"count", vertex_count},
                         {"type", types[components - 1]}});
}

std::size_t writer::add_directions(piece::kind type, const float *values,
                                   std::uint32_t vertex_count) {
    const std::size_t view = add_view({type, values, vertex_count}, target_vertices);
    return add_accessor({{"bufferView", view},
                         {"componentType", type_f32},
                         {"count", vertex_count},
                         {"type", type == piece::normals ? "VEC3" : "VEC4"}});
}

json writer::primitive(std::size_t mesh_index, std::size_t primitive_index) {
    const girih_gltf_primitive &source = model_.meshes[mesh_index].primitives[primitive_index];
    const girih_gltf_refined_primitive &refined = refined_[mesh_index][primitive_index];
    const std::string where = std::string("mesh '") + model_.meshes[mesh_index].name +
                              "', primitive " + std::to_string(primitive_index);
    json description = root_["meshes"][mesh_index]["primitives"]
                            [model_.source_primitives[mesh_index][primitive_index]];
    for (const char *member : {"mode", "indices", "targets"}) {
        description.erase(member);
    }
    json &attributes = description["attributes"] = json::object();

    float low[3], high[3];
    for (std::size_t i = 0; i < std::size_t{3} * refined.vertex_count; i++) {
        const float value = refined.positions[i];
        if (!std::isfinite(value)) {
            throw refusal(where + ": a position is not finite");
        }
        low[i % 3] = i < 3 ? value : std::min(low[i % 3], value);
        high[i % 3] = i < 3 ? value : std::max(high[i % 3], value);
    }
    for (std::size_t i = 0; i < refined.index_count; i++) {
        if (refined.indices[i] >= refined.vertex_count) {
            throw refusal(where + ": an index is out of range");
        }
    }
    const std::size_t positions = add_floats(refined.positions, refined.vertex_count, 3);
    accessors_[positions]["min"] = json(low);
    accessors_[positions]["max"] = json(high);
    attributes["POSITION"] = positions;
    if (refined.normals != nullptr) {
        attributes["NORMAL"] =
            add_directions(piece::normals, refined.normals, refined.vertex_count);
    }
    for (std::uint32_t a = 0; a < source.attribute_count; a++) {
        const girih_gltf_attribute &attribute = source.attributes[a];
        if (std::strcmp(attribute.name, "TANGENT") == 0) {
            attributes["TANGENT"] =
                add_directions(piece::tangents, refined.attributes[a], refined.vertex_count);
        } else {
            attributes[attribute.name] =
                add_floats(refined.attributes[a], refined.vertex_count, attribute.components);
        }
    }
    const bool is_short = refined.vertex_count <= greatest_short_vertex_count;
    const std::size_t view = add_view(
        {is_short ? piece::short_indices : piece::indices, refined.indices, refined.index_count},
        target_indices);
    description["indices"] = add_accessor({{"bufferView", view},
                                           {"componentType", is_short ? type_u16 : type_u32},
                                           {"count", refined.index_count},
                                           {"type", "SCALAR"}});
    return description;
}

// glTF wants at least one primitive in a mesh and one triangle in a primitive: what has none goes.
void writer::describe_meshes() {
    json meshes = json::array();
    std::vector<json> new_index(model_.meshes.size());
    for (std::size_t m = 0; m < model_.meshes.size(); m++) {
        json primitives = json::array();
        for (std::uint32_t p = 0; p < model_.meshes[m].primitive_count; p++) {
            if (refined_[m][p].index_count >= 3 && refined_[m][p].vertex_count > 0) {
                primitives.push_back(primitive(m, p));
            }
        }
        if (primitives.empty()) {
            continue;
        }
        json mesh = root_["meshes"][m];
        mesh.erase("weights");
        if (mesh.contains("extras") && mesh["extras"].is_object()) {
            mesh["extras"].erase("targetNames"); // the names of morph targets, by convention
        }
        mesh["primitives"] = std::move(primitives);
        new_index[m] = meshes.size();
        meshes.push_back(std::move(mesh));
    }
    if (root_.contains("nodes")) {
        for (json &node : root_["nodes"]) {
            node.erase("skin");
            node.erase("weights");
            if (node.contains("mesh")) {
                const json &index = new_index[node["mesh"].get<std::size_t>()];
                if (index.is_null()) {
                    node.erase("mesh");
                } else {
                    node["mesh"] = index;
                }
            }
        }
    }
    root_["meshes"] = std::move(meshes);
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
    for (const char *part : {"animations", "skins"}) {
        root_.erase(part);
    }
    root_["accessors"] = std::move(accessors_);
    root_["bufferViews"] = std::move(views_);
    root_["buffers"] = json::array();
    if (binary_size_ > 0) {
        root_["buffers"].push_back({{"byteLength", binary_size_}});
    }
    std::set<std::string> occurring;
    collect_extensions(root_, occurring);
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
    } else {
        std::fwrite(part.data, 1, static_cast<std::size_t>(piece_size(part)), stream);
    }
    const std::uint64_t size = piece_size(part);
    std::fwrite("\0\0\0", 1, static_cast<std::size_t>(padded(size) - size), stream);
}

void writer::write(const char *path) {
    drop_all_extensions(root_);
    describe_meshes();
    describe_images();
    describe_rest();

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
    // These messages begin with the path, and so will what a refusal becomes.
    const std::size_t prefix = std::string(path).size() + 2;
    if (!girih_output_open(&file, path, message, sizeof message)) {
        throw refusal(std::string(message).substr(prefix));
    }
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
        throw refusal(message);
    }
}

} // namespace

void write_model(const girih_gltf_model &model, const girih_gltf_refined_primitive *const *refined,
                 const char *path) {
    writer(model, refined).write(path);
}

} // namespace girih_gltf
