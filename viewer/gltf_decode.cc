// Compressed geometry, decoded once when a file is opened: the document becomes the one that it was
// compressed from, so that nobody behind here knows of compression. KHR_draco_mesh_compression for
// primitives; EXT_meshopt_compression, and KHR_meshopt_compression as far as the library's format
// version 0 goes, for buffer views.
#include "gltf_model.hh"

#include <cstring>
#include <memory>

#include <draco/compression/decode.h>
#include <meshoptimizer.h>

namespace girih_gltf {
namespace {

const char *const draco_name = "KHR_draco_mesh_compression";
const char *const decompress_hint = "; decompress the file with another program, or export it "
                                    "without compression";

const json *find_extension(const json &owner, const char *name) {
    const auto extensions = owner.find("extensions");
    if (extensions == owner.end()) {
        return nullptr;
    }
    const auto extension = extensions->find(name);
    return extension == extensions->end() ? nullptr : &*extension;
}

void erase_extension(json &owner, const char *name) {
    owner["extensions"].erase(name);
    if (owner["extensions"].empty()) {
        owner.erase("extensions");
    }
}

// --- meshoptimizer ---

bool is_stride(const std::string &mode, std::uint64_t stride) {
    return mode == "ATTRIBUTES" ? stride % 4 == 0 && stride > 0 && stride <= 256
                                : stride == 2 || stride == 4;
}

bool is_filter(const std::string &filter, const std::string &mode, std::uint64_t stride) {
    return filter == "NONE" ||
           (mode == "ATTRIBUTES" &&
            ((filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
             (filter == "QUATERNION" && stride == 8) || filter == "EXPONENTIAL"));
}

// The densest mode, ATTRIBUTES, spends 2 bits on 16 bytes at least: beyond that a count is a lie,
// and no reason to ask for memory.
constexpr std::uint64_t greatest_ratio = 64;

bytes decode_view(document &source, const json &extension, const std::string &where) {
    const std::uint64_t count = extension["count"], stride = extension["byteStride"];
    const std::string &mode = extension["mode"].get_ref<const std::string &>();
    const std::string filter = extension.value("filter", "NONE");
    const bool is_triangles = mode == "TRIANGLES";
    if ((mode != "ATTRIBUTES" && !is_triangles && mode != "INDICES") || !is_stride(mode, stride) ||
        (is_triangles && count % 3 != 0)) {
        throw refusal(where + ": mode " + mode.substr(0, 20) + " with " + std::to_string(count) +
                      " elements of " + std::to_string(stride) + " bytes cannot be");
    }
    if (!is_filter(filter, mode, stride)) {
        throw refusal(where + ": filter " + filter.substr(0, 20) + " of elements of " +
                      std::to_string(stride) + " bytes is not supported" + decompress_hint);
    }
    const document::span packed =
        source.range(extension["buffer"], extension.value("byteOffset", std::uint64_t{0}),
                     extension["byteLength"], where);
    if (count > packed.size * greatest_ratio / stride) {
        throw refusal(where + ": " + std::to_string(count) + " elements are more than its " +
                      std::to_string(packed.size) + " bytes can hold");
    }
    bytes decoded(static_cast<std::size_t>(count * stride));
    const auto elements = static_cast<std::size_t>(count), size = static_cast<std::size_t>(stride);
    const int failed =
        mode == "ATTRIBUTES"
            ? meshopt_decodeVertexBuffer(decoded.data(), elements, size, packed.data, packed.size)
        : is_triangles
            ? meshopt_decodeIndexBuffer(decoded.data(), elements, size, packed.data, packed.size)
            : meshopt_decodeIndexSequence(decoded.data(), elements, size, packed.data, packed.size);
    if (failed != 0) {
        throw refusal(where + ": damaged, or of a newer format version" + decompress_hint);
    }
    if (filter == "OCTAHEDRAL") {
        meshopt_decodeFilterOct(decoded.data(), elements, size);
    } else if (filter == "QUATERNION") {
        meshopt_decodeFilterQuat(decoded.data(), elements, size);
    } else if (filter == "EXPONENTIAL") {
        meshopt_decodeFilterExp(decoded.data(), elements, size);
    }
    return decoded;
}

void decode_views(document &source) {
    for (std::size_t i = 0; i < source.count("bufferViews"); i++) {
        for (const char *name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
            const std::string where = "buffer view " + std::to_string(i) + ", " + name;
            json &view = source.root["bufferViews"][i];
            const json *extension = find_extension(view, name);
            if (extension == nullptr) {
                continue;
            }
            bytes decoded = decode_view(source, *extension, where);
            if (view["byteLength"] != decoded.size()) {
                throw refusal(where + ": " + std::to_string(decoded.size()) +
                              " bytes come out, the view has " + view["byteLength"].dump());
            }
            erase_extension(view, name);
            view["byteOffset"] = 0;
            view["buffer"] = source.add_buffer(std::move(decoded));
        }
    }
}

// --- Draco ---

template <typename Component>
void convert(const draco::PointAttribute &attribute, std::uint32_t point_count, bytes &to,
             const std::string &where) {
    const unsigned components = attribute.num_components();
    to.resize(std::size_t{point_count} * components * sizeof(Component));
    std::vector<Component> value(components);
    for (std::uint32_t i = 0; i < point_count; i++) {
        const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(i));
        if (index.value() >= attribute.size() ||
            !attribute.ConvertValue(index, static_cast<std::int8_t>(components), value.data())) {
            throw refusal(where + ": value of vertex " + std::to_string(i) +
                          " does not fit its accessor");
        }
        std::memcpy(to.data() + std::size_t{i} * components * sizeof(Component), value.data(),
                    components * sizeof(Component));
    }
}

bytes attribute_bytes(const draco::PointAttribute &attribute, std::uint32_t point_count,
                      std::uint64_t component_type, const std::string &where) {
    bytes data;
    switch (component_type) {
    case type_i8:
        convert<std::int8_t>(attribute, point_count, data, where);
        break;
    case type_u8:
        convert<std::uint8_t>(attribute, point_count, data, where);
        break;
    case type_i16:
        convert<std::int16_t>(attribute, point_count, data, where);
        break;
    case type_u16:
        convert<std::uint16_t>(attribute, point_count, data, where);
        break;
    case type_u32:
        convert<std::uint32_t>(attribute, point_count, data, where);
        break;
    case type_f32:
        convert<float>(attribute, point_count, data, where);
        break;
    default:
        throw refusal(where + ": unknown component type " + std::to_string(component_type));
    }
    return data;
}

// Other primitives may use the accessor for other data, so it is copied.
std::size_t add_accessor(document &source, json accessor, bytes data) {
    json &views = source.root["bufferViews"], &accessors = source.root["accessors"];
    const std::size_t size = data.size();
    views.push_back({{"buffer", source.add_buffer(std::move(data))}, {"byteLength", size}});
    accessor.erase("byteOffset");
    accessor.erase("sparse");
    accessor["bufferView"] = views.size() - 1;
    accessors.push_back(std::move(accessor));
    return accessors.size() - 1;
}

std::unique_ptr<draco::Mesh> decode_mesh(document &source, const json &extension,
                                         const std::string &where) {
    const document::span packed = source.view(extension["bufferView"]);
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char *>(packed.data), packed.size);
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) {
        const std::string reason = decoded.status().error_msg_string();
        throw refusal(where + ": damaged" + (reason.empty() ? "" : " (" + reason + ")"));
    }
    std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
    if (mesh->num_points() == 0 || mesh->num_faces() == 0) {
        throw refusal(where + ": without triangles");
    }
    return mesh;
}

void decode_primitive(document &source, json &primitive, const std::string &where) {
    const json extension = *find_extension(primitive, draco_name);
    const std::unique_ptr<draco::Mesh> mesh = decode_mesh(source, extension, where);
    const std::uint32_t point_count = mesh->num_points();
    for (const auto &member : extension["attributes"].items()) {
        const std::string part = where + ", " + member.key();
        const auto index = primitive["attributes"].find(member.key());
        if (index == primitive["attributes"].end()) {
            throw refusal(part + ": the primitive has no such attribute");
        }
        const json &accessor = source.root["accessors"][index->get<std::size_t>()];
        const draco::PointAttribute *attribute =
            mesh->GetAttributeByUniqueId(member.value().get<std::uint32_t>());
        if (attribute == nullptr) {
            throw refusal(part + ": there is no attribute of number " + member.value().dump());
        }
        if (accessor["count"] != point_count ||
            component_count(accessor) != attribute->num_components()) {
            throw refusal(part + ": " + std::to_string(point_count) + " elements of " +
                          std::to_string(attribute->num_components()) +
                          " components come out, the accessor wants others");
        }
        bytes data = attribute_bytes(*attribute, point_count, accessor["componentType"], part);
        *index = add_accessor(source, accessor, std::move(data));
    }
    bytes indices(std::size_t{mesh->num_faces()} * 3 * sizeof(std::uint32_t));
    for (std::uint32_t f = 0; f < mesh->num_faces(); f++) {
        const draco::Mesh::Face &face = mesh->face(draco::FaceIndex(f));
        for (std::size_t c = 0; c < 3; c++) {
            const std::uint32_t corner = face[c].value();
            std::memcpy(indices.data() + (std::size_t{f} * 3 + c) * sizeof corner, &corner,
                        sizeof corner);
        }
    }
    json accessor = {
        {"componentType", type_u32}, {"count", indices.size() / 4}, {"type", "SCALAR"}};
    primitive["indices"] = add_accessor(source, std::move(accessor), std::move(indices));
    primitive.erase("mode"); // strips come out as triangles
    erase_extension(primitive, draco_name);
}

void decode_primitives(document &source) {
    for (std::size_t m = 0; m < source.count("meshes"); m++) {
        json &primitives = source.root["meshes"][m]["primitives"];
        for (std::size_t p = 0; p < primitives.size(); p++) {
            if (find_extension(primitives[p], draco_name) != nullptr) {
                decode_primitive(source, primitives[p],
                                 label(source.root, "meshes", "mesh", m) + ", primitive " +
                                     std::to_string(p) + ", " + draco_name);
            }
        }
    }
}

} // namespace

void decode_compressed(document &source) {
    decode_views(source);
    decode_primitives(source);
}

} // namespace girih_gltf
