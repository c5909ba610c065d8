// The types of a document's properties and the targets of its indices, as data: one rule for each
// property that girih reads (glTF 2.0, section 5). Everything behind this check may trust both.
#include "gltf_model.hh"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

namespace girih_gltf {
namespace {

enum class kind { object, array, string, boolean, number, integer, index, numbers };

constexpr std::uint64_t any_size = std::numeric_limits<std::int64_t>::max();

struct rule {
    const char *path; // members, separated by '/'; '*': every element or member
    kind type;
    bool required;
    std::uint64_t minimum, maximum; // integer: its range; numbers: maximum is their count, 0: any
    const char *target;             // index: the top-level array it points into
};

constexpr rule required_object(const char *path) {
    return {path, kind::object, true, 0, 0, nullptr};
}
constexpr rule object(const char *path) {
    return {path, kind::object, false, 0, 0, nullptr};
}
constexpr rule array(const char *path) {
    return {path, kind::array, false, 0, 0, nullptr};
}
constexpr rule required_array(const char *path) {
    return {path, kind::array, true, 0, 0, nullptr};
}
constexpr rule string(const char *path) {
    return {path, kind::string, false, 0, 0, nullptr};
}
constexpr rule required_string(const char *path) {
    return {path, kind::string, true, 0, 0, nullptr};
}
constexpr rule boolean(const char *path) {
    return {path, kind::boolean, false, 0, 0, nullptr};
}
constexpr rule number(const char *path) {
    return {path, kind::number, false, 0, 0, nullptr};
}
constexpr rule required_number(const char *path) {
    return {path, kind::number, true, 0, 0, nullptr};
}
constexpr rule numbers(const char *path, std::uint64_t count) {
    return {path, kind::numbers, false, 0, count, nullptr};
}
constexpr rule integer(const char *path, std::uint64_t minimum, std::uint64_t maximum) {
    return {path, kind::integer, false, minimum, maximum, nullptr};
}
constexpr rule required_integer(const char *path, std::uint64_t minimum, std::uint64_t maximum) {
    return {path, kind::integer, true, minimum, maximum, nullptr};
}
constexpr rule index(const char *path, const char *target) {
    return {path, kind::index, false, 0, 0, target};
}
constexpr rule required_index(const char *path, const char *target) {
    return {path, kind::index, true, 0, 0, target};
}

constexpr std::uint64_t greatest_enum = 65535;

#define MESHOPT_RULES(name)                                                                        \
    object("bufferViews/*/extensions/" name),                                                      \
        required_index("bufferViews/*/extensions/" name "/buffer", "buffers"),                     \
        integer("bufferViews/*/extensions/" name "/byteOffset", 0, any_size),                      \
        required_integer("bufferViews/*/extensions/" name "/byteLength", 1, any_size),             \
        required_integer("bufferViews/*/extensions/" name "/byteStride", 1, 256),                  \
        required_integer("bufferViews/*/extensions/" name "/count", 1, any_size),                  \
        required_string("bufferViews/*/extensions/" name "/mode"),                                 \
        string("bufferViews/*/extensions/" name "/filter")

// A container stands before its members, so that a rule can rely on what leads to it.
constexpr rule rules[] = {
    required_object("asset"),
    required_string("asset/version"),
    string("asset/minVersion"),
    array("extensionsUsed"),
    string("extensionsUsed/*"),
    array("extensionsRequired"),
    string("extensionsRequired/*"),
    object("extensions"),

    array("buffers"),
    object("buffers/*"),
    required_integer("buffers/*/byteLength", 1, any_size),
    string("buffers/*/uri"),

    array("bufferViews"),
    object("bufferViews/*"),
    required_index("bufferViews/*/buffer", "buffers"),
    integer("bufferViews/*/byteOffset", 0, any_size),
    required_integer("bufferViews/*/byteLength", 1, any_size),
    integer("bufferViews/*/byteStride", 0, 252),
    object("bufferViews/*/extensions"),
    MESHOPT_RULES("EXT_meshopt_compression"),
    MESHOPT_RULES("KHR_meshopt_compression"),

    array("accessors"),
    object("accessors/*"),
    index("accessors/*/bufferView", "bufferViews"),
    integer("accessors/*/byteOffset", 0, any_size),
    required_integer("accessors/*/componentType", 0, greatest_enum),
    boolean("accessors/*/normalized"),
    required_integer("accessors/*/count", 1, any_size),
    required_string("accessors/*/type"),
    object("accessors/*/sparse"),
    required_integer("accessors/*/sparse/count", 1, any_size),
    required_object("accessors/*/sparse/indices"),
    required_index("accessors/*/sparse/indices/bufferView", "bufferViews"),
    integer("accessors/*/sparse/indices/byteOffset", 0, any_size),
    required_integer("accessors/*/sparse/indices/componentType", 0, greatest_enum),
    required_object("accessors/*/sparse/values"),
    required_index("accessors/*/sparse/values/bufferView", "bufferViews"),
    integer("accessors/*/sparse/values/byteOffset", 0, any_size),

    array("images"),
    object("images/*"),
    string("images/*/uri"),
    index("images/*/bufferView", "bufferViews"),
    string("images/*/mimeType"),

    array("samplers"),
    object("samplers/*"),
    integer("samplers/*/magFilter", 0, greatest_enum),
    integer("samplers/*/minFilter", 0, greatest_enum),
    integer("samplers/*/wrapS", 0, greatest_enum),
    integer("samplers/*/wrapT", 0, greatest_enum),

    array("textures"),
    object("textures/*"),
    object("textures/*/extensions"),
    index("textures/*/sampler", "samplers"),
    index("textures/*/source", "images"),

    array("materials"),
    object("materials/*"),
    object("materials/*/extensions"),
    object("materials/*/pbrMetallicRoughness"),
    numbers("materials/*/pbrMetallicRoughness/baseColorFactor", 4),
    number("materials/*/pbrMetallicRoughness/metallicFactor"),
    number("materials/*/pbrMetallicRoughness/roughnessFactor"),
    object("materials/*/pbrMetallicRoughness/baseColorTexture"),
    required_index("materials/*/pbrMetallicRoughness/baseColorTexture/index", "textures"),
    integer("materials/*/pbrMetallicRoughness/baseColorTexture/texCoord", 0, greatest_enum),
    object("materials/*/pbrMetallicRoughness/baseColorTexture/extensions"),
    object("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform"),
    numbers("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/"
            "offset",
            2),
    numbers("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/"
            "scale",
            2),
    number("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/"
           "rotation"),
    integer("materials/*/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/"
            "texCoord",
            0, greatest_enum),
    object("materials/*/pbrMetallicRoughness/metallicRoughnessTexture"),
    required_index("materials/*/pbrMetallicRoughness/metallicRoughnessTexture/index", "textures"),
    object("materials/*/normalTexture"),
    required_index("materials/*/normalTexture/index", "textures"),
    integer("materials/*/normalTexture/texCoord", 0, greatest_enum),
    number("materials/*/normalTexture/scale"),
    object("materials/*/normalTexture/extensions"),
    object("materials/*/normalTexture/extensions/KHR_texture_transform"),
    numbers("materials/*/normalTexture/extensions/KHR_texture_transform/offset", 2),
    numbers("materials/*/normalTexture/extensions/KHR_texture_transform/scale", 2),
    number("materials/*/normalTexture/extensions/KHR_texture_transform/rotation"),
    integer("materials/*/normalTexture/extensions/KHR_texture_transform/texCoord", 0,
            greatest_enum),
    object("materials/*/occlusionTexture"),
    required_index("materials/*/occlusionTexture/index", "textures"),
    object("materials/*/emissiveTexture"),
    required_index("materials/*/emissiveTexture/index", "textures"),
    numbers("materials/*/emissiveFactor", 3),
    string("materials/*/alphaMode"),
    number("materials/*/alphaCutoff"),
    boolean("materials/*/doubleSided"),

    array("cameras"),
    object("cameras/*"),
    required_string("cameras/*/type"),
    object("cameras/*/perspective"),
    number("cameras/*/perspective/aspectRatio"),
    required_number("cameras/*/perspective/yfov"),
    number("cameras/*/perspective/zfar"),
    required_number("cameras/*/perspective/znear"),
    object("cameras/*/orthographic"),
    required_number("cameras/*/orthographic/xmag"),
    required_number("cameras/*/orthographic/ymag"),
    required_number("cameras/*/orthographic/zfar"),
    required_number("cameras/*/orthographic/znear"),

    array("meshes"),
    object("meshes/*"),
    required_array("meshes/*/primitives"),
    object("meshes/*/primitives/*"),
    object("meshes/*/primitives/*/extensions"),
    required_object("meshes/*/primitives/*/attributes"),
    index("meshes/*/primitives/*/attributes/*", "accessors"),
    object("meshes/*/primitives/*/extensions/KHR_draco_mesh_compression"),
    required_index("meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/bufferView",
                   "bufferViews"),
    required_object("meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/attributes"),
    integer("meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/attributes/*", 0,
            0xffffffff),
    index("meshes/*/primitives/*/indices", "accessors"),
    index("meshes/*/primitives/*/material", "materials"),
    integer("meshes/*/primitives/*/mode", 0, 6),
    array("meshes/*/primitives/*/targets"),
    object("meshes/*/primitives/*/targets/*"),
    index("meshes/*/primitives/*/targets/*/*", "accessors"),
    numbers("meshes/*/weights", 0),

    array("nodes"),
    object("nodes/*"),
    object("nodes/*/extensions"),
    array("nodes/*/children"),
    index("nodes/*/children/*", "nodes"),
    index("nodes/*/mesh", "meshes"),
    index("nodes/*/camera", "cameras"),
    index("nodes/*/skin", "skins"),
    numbers("nodes/*/matrix", 16),
    numbers("nodes/*/translation", 3),
    numbers("nodes/*/rotation", 4),
    numbers("nodes/*/scale", 3),
    object("nodes/*/extensions/EXT_mesh_gpu_instancing"),
    object("nodes/*/extensions/EXT_mesh_gpu_instancing/attributes"),
    index("nodes/*/extensions/EXT_mesh_gpu_instancing/attributes/*", "accessors"),
    numbers("nodes/*/weights", 0),

    array("skins"),
    object("skins/*"),
    index("skins/*/inverseBindMatrices", "accessors"),
    index("skins/*/skeleton", "nodes"),
    required_array("skins/*/joints"),
    index("skins/*/joints/*", "nodes"),

    array("animations"),
    object("animations/*"),
    required_array("animations/*/channels"),
    object("animations/*/channels/*"),
    required_integer("animations/*/channels/*/sampler", 0, any_size),
    required_object("animations/*/channels/*/target"),
    index("animations/*/channels/*/target/node", "nodes"),
    required_string("animations/*/channels/*/target/path"),
    required_array("animations/*/samplers"),
    object("animations/*/samplers/*"),
    required_index("animations/*/samplers/*/input", "accessors"),
    required_index("animations/*/samplers/*/output", "accessors"),
    string("animations/*/samplers/*/interpolation"),

    array("scenes"),
    object("scenes/*"),
    array("scenes/*/nodes"),
    index("scenes/*/nodes/*", "nodes"),
    index("scene", "scenes"),
};

[[noreturn]] void refuse(const std::string &where, const char *wanted) {
    throw refusal("property " + where + ": " + wanted);
}

// JSON has one kind of number, and some exporters write 2.0 for 2.
bool make_integer(json &value) {
    if (value.is_number_unsigned()) {
        return value.get<std::uint64_t>() <= any_size;
    }
    if (!value.is_number_float()) {
        return false; // a negative integer, or no number at all
    }
    const double number = value.get<double>();
    if (!(number >= 0.0 && number <= 9007199254740992.0) || number != std::floor(number)) {
        return false;
    }
    value = static_cast<std::uint64_t>(number);
    return true;
}

void check_value(const json &root, const rule &rule, json &value, const std::string &where) {
    switch (rule.type) {
    case kind::object:
        if (!value.is_object()) {
            refuse(where, "must be an object");
        }
        break;
    case kind::array:
        if (!value.is_array()) {
            refuse(where, "must be an array");
        }
        break;
    case kind::string:
        if (!value.is_string()) {
            refuse(where, "must be a string");
        }
        break;
    case kind::boolean:
        if (!value.is_boolean()) {
            refuse(where, "must be true or false");
        }
        break;
    case kind::number:
        if (!value.is_number()) {
            refuse(where, "must be a number");
        }
        break;
    case kind::numbers:
        if (!value.is_array() || (rule.maximum != 0 && value.size() != rule.maximum) ||
            !std::all_of(value.begin(), value.end(),
                         [](const json &element) { return element.is_number(); })) {
            refuse(where,
                   ("must be " + (rule.maximum == 0 ? "" : std::to_string(rule.maximum) + " ") +
                    "numbers")
                       .c_str());
        }
        break;
    case kind::integer:
        if (!make_integer(value) || value.get<std::uint64_t>() < rule.minimum ||
            value.get<std::uint64_t>() > rule.maximum) {
            refuse(
                where,
                ("must be a whole number of at least " + std::to_string(rule.minimum) +
                 (rule.maximum == any_size ? "" : " and at most " + std::to_string(rule.maximum)))
                    .c_str());
        }
        break;
    case kind::index: {
        if (!make_integer(value)) {
            refuse(where, "must be an index");
        }
        const auto elements = root.find(rule.target);
        const std::size_t count = elements == root.end() ? 0 : elements->size();
        if (value.get<std::uint64_t>() >= count) {
            refuse(where, ("is " + value.dump() + ", but there are only " + std::to_string(count) +
                           " " + rule.target)
                              .c_str());
        }
        break;
    }
    }
}

void apply(const json &root, const rule &rule, const char *path, json &value,
           const std::string &where) {
    if (*path == '\0') {
        check_value(root, rule, value, where);
        return;
    }
    const char *slash = std::strchr(path, '/');
    const std::string member = slash == nullptr ? path : std::string(path, slash);
    const char *rest = slash == nullptr ? "" : slash + 1;
    if (member == "*") {
        for (auto element = value.begin(); element != value.end(); ++element) {
            const std::string name =
                value.is_object() ? element.key() : std::to_string(element - value.begin());
            apply(root, rule, rest, *element, where + "/" + name);
        }
        return;
    }
    const auto found = value.find(member);
    if (found != value.end()) {
        apply(root, rule, rest, *found, where + "/" + member);
    } else if (rule.required && *rest == '\0') {
        throw refusal("property " + where + "/" + member + ": is missing");
    }
}

const std::set<std::string> understood = {
    "KHR_texture_transform",      "KHR_materials_unlit",     "KHR_mesh_quantization",
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"};

// Optional extensions that leave the picture girih draws as it is: the base colour, metallic,
// roughness and emission of a surface.
const std::set<std::string> harmless = {
    "KHR_lights_punctual",
    "KHR_materials_variants",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_animation_pointer",
    "KHR_audio_emitter",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "EXT_lights_image_based",
    "EXT_structural_metadata",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "CESIUM_primitive_outline",
};

// Buffer views must lie within their buffers' stated lengths and accessors within their views,
// whether something uses them or not. No sum here can overflow: every size is below 2^63.
void check_ranges(const json &root) {
    const json none = json::array();
    const json &views = root.contains("bufferViews") ? root["bufferViews"] : none;
    for (std::size_t i = 0; i < views.size(); i++) {
        const std::size_t buffer = views[i]["buffer"];
        const std::uint64_t buffer_size = root["buffers"][buffer]["byteLength"];
        const std::uint64_t offset = views[i].value("byteOffset", std::uint64_t{0});
        const std::uint64_t size = views[i]["byteLength"];
        if (offset > buffer_size || size > buffer_size - offset) {
            throw refusal("buffer view " + std::to_string(i) + ": reaches beyond the " +
                          std::to_string(buffer_size) + " bytes of buffer " +
                          std::to_string(buffer));
        }
        if (views[i].value("byteStride", std::uint64_t{0}) > size) {
            throw refusal("buffer view " + std::to_string(i) +
                          ": its stride is larger than the view");
        }
    }
    const json &accessors = root.contains("accessors") ? root["accessors"] : none;
    for (std::size_t i = 0; i < accessors.size(); i++) {
        const element_layout element = layout_of(accessors[i]);
        if (element.size == 0 || !accessors[i].contains("bufferView")) {
            continue;
        }
        const std::size_t view = accessors[i]["bufferView"];
        const std::uint64_t view_size = views[view]["byteLength"];
        const std::uint64_t offset = accessors[i].value("byteOffset", std::uint64_t{0});
        const std::uint64_t stride = views[view].value("byteStride", std::uint64_t{0});
        const std::uint64_t count = accessors[i]["count"];
        if (offset > view_size || element.size > view_size - offset ||
            count - 1 >
                (view_size - offset - element.size) / (stride == 0 ? element.distance : stride)) {
            throw refusal(label(root, "accessors", "accessor", i) + ": its " +
                          std::to_string(count) + " elements reach beyond the " +
                          std::to_string(view_size) + " bytes of buffer view " +
                          std::to_string(view));
        }
    }
}

} // namespace

element_layout layout_of(const json &accessor) {
    const std::uint64_t component_type = accessor["componentType"];
    const std::string &type = accessor["type"].get_ref<const std::string &>();
    const std::uint64_t component = component_type == 5120 || component_type == 5121   ? 1
                                    : component_type == 5122 || component_type == 5123 ? 2
                                    : component_type == 5125 || component_type == 5126 ? 4
                                                                                       : 0;
    if (type == "SCALAR") {
        return {component, component};
    }
    if (type.size() != 4 || type[3] < '2' || type[3] > '4') {
        return {0, 0};
    }
    const std::uint64_t count = static_cast<std::uint64_t>(type[3] - '0');
    if (type.compare(0, 3, "MAT") == 0) {
        // Columns begin at multiples of 4 (glTF 2.0, section 3.6.2.4); the last is not padded.
        const std::uint64_t column = (count * component + 3) / 4 * 4;
        return {(count - 1) * column + count * component, count * column};
    }
    const std::uint64_t size = type.compare(0, 3, "VEC") == 0 ? count * component : 0;
    return {size, size};
}

void check_document(json &root) {
    if (!root.is_object()) {
        throw refusal("the JSON is not an object");
    }
    for (const rule &rule : rules) {
        apply(root, rule, rule.path, root, "");
    }
    for (const char *key : {"minVersion", "version"}) {
        const std::string version = root["asset"].value(key, "2.0");
        if (version.compare(0, 2, "2.") != 0) {
            throw refusal("glTF version " + version.substr(0, 20) + ": only 2.0 is supported");
        }
    }
    for (json &camera : root.value("cameras", json::array())) {
        const std::string type = camera["type"];
        if ((type != "perspective" && type != "orthographic") || !camera.contains(type)) {
            throw refusal("a camera is neither perspective nor orthographic");
        }
    }
    check_ranges(root);
}

void check_extensions(const json &root, const warner &warn) {
    for (const json &element : root.value("extensionsRequired", json::array())) {
        const std::string name = element;
        if (understood.count(name) != 0) {
            continue;
        }
        throw refusal("required extension " + name +
                      " is not supported; export the file without it");
    }
    for (const json &element : root.value("extensionsUsed", json::array())) {
        const std::string name = element;
        if (understood.count(name) == 0 && harmless.count(name) == 0) {
            warn("extension " + name + " is not known and has no effect here");
        }
    }
}

} // namespace girih_gltf
