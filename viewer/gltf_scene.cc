// The scene around the meshes: node transforms, cameras, materials and their textures, as tinygltf
// reads them from the checked document.
#include "gltf_model.hh"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstring>

#include <stb_image.h>
#include <tiny_gltf.h>

namespace girih_gltf {
namespace {

// Larger pictures are more likely a damaged header than a texture (16384 x 16384).
constexpr std::int64_t greatest_pixel_count = std::int64_t{1} << 28;

// Rows of a 3x4 matrix, in double: deep hierarchies lose little that way.
using transform = std::array<double, 12>;

constexpr transform identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

transform product(const transform &a, const transform &b) {
    transform c;
    for (std::size_t row = 0; row < 3; row++) {
        for (std::size_t column = 0; column < 4; column++) {
            double sum = column == 3 ? a[4 * row + 3] : 0.0;
            for (std::size_t k = 0; k < 3; k++) {
                sum += a[4 * row + k] * b[4 * k + column];
            }
            c[4 * row + column] = sum;
        }
    }
    return c;
}

transform local_transform(const tinygltf::Node &node) {
    transform m = identity;
    if (node.matrix.size() == 16) {
        for (std::size_t row = 0; row < 3; row++) {
            for (std::size_t column = 0; column < 4; column++) {
                m[4 * row + column] = node.matrix[4 * column + row];
            }
        }
        return m;
    }
    if (node.rotation.size() == 4) {
        const double length =
            std::sqrt(node.rotation[0] * node.rotation[0] + node.rotation[1] * node.rotation[1] +
                      node.rotation[2] * node.rotation[2] + node.rotation[3] * node.rotation[3]);
        if (length > 0.0 && std::isfinite(length)) {
            const double x = node.rotation[0] / length, y = node.rotation[1] / length,
                         z = node.rotation[2] / length, w = node.rotation[3] / length;
            m = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),     0,
                 2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),     0,
                 2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y), 0};
        }
    }
    for (std::size_t row = 0; row < 3; row++) {
        for (std::size_t column = 0; column < 3 && node.scale.size() == 3; column++) {
            m[4 * row + column] *= node.scale[column];
        }
        if (node.translation.size() == 3) {
            m[4 * row + 3] = node.translation[row];
        }
    }
    return m;
}

float clamped(double value, double low, double high) {
    return static_cast<float>(std::fmin(std::fmax(value, low), high));
}

// A number from the file as a float, never infinite.
float finite(double value) {
    return clamped(value, -3.4028234663852886e38, 3.4028234663852886e38);
}

class scene_loader {
  public:
    scene_loader(girih_gltf_model &model, const document &source, const warner &warn);
    void load();

  private:
    std::vector<std::size_t> node_parents() const;
    void place(std::size_t node_index, const transform &world);
    void load_nodes();
    void load_materials();
    girih_gltf_texture texture_use(int index, int texcoord,
                                   const tinygltf::ExtensionMap &extensions, const char *material);
    std::int32_t decoded_image(std::size_t image_index);

    girih_gltf_model &model_;
    const document &source_;
    const warner &warn_;
    tinygltf::Model scene_;
    std::map<std::size_t, std::int32_t>
        decoded_; // image of the file: index into model_.images or -1
};

scene_loader::scene_loader(girih_gltf_model &model, const document &source, const warner &warn)
    : model_(model), source_(source), warn_(warn) {
    // Only what is read through tinygltf goes to it: it would open buffers and images itself,
    // refuses valid accessors, and needs neither.
    json description = {{"asset", {{"version", "2.0"}}}};
    for (const char *part : {"nodes", "materials", "textures", "samplers", "cameras"}) {
        json &elements = description[part] = json::array();
        for (json element : source.root.value(part, json::array())) {
            element.erase("extras");
            elements.push_back(std::move(element));
        }
    }
    const std::string text = description.dump();
    if (text.size() > UINT_MAX) {
        throw refusal("the scene description is too large");
    }
    tinygltf::TinyGLTF reader;
    std::string error, warning;
    if (!reader.LoadASCIIFromString(&scene_, &error, &warning, text.c_str(),
                                    static_cast<unsigned>(text.size()), "", tinygltf::NO_REQUIRE)) {
        throw refusal("the scene cannot be read: " + error);
    }
}

constexpr std::size_t none = SIZE_MAX;

// Every node's parent. Refuses a node with two, and one that is its own ancestor (glTF 2.0, section
// 3.5.2).
std::vector<std::size_t> scene_loader::node_parents() const {
    std::vector<std::size_t> parents(scene_.nodes.size(), none);
    for (std::size_t i = 0; i < scene_.nodes.size(); i++) {
        for (const int child_index : scene_.nodes[i].children) {
            std::size_t &parent = parents[static_cast<std::size_t>(child_index)];
            if (parent != none) {
                throw refusal(
                    label(source_.root, "nodes", "node", static_cast<std::size_t>(child_index)) +
                    ": has two parents, nodes " + std::to_string(parent) + " and " +
                    std::to_string(i));
            }
            parent = i;
        }
    }
    // With one parent each, a walk upwards either ends at a root or goes round.
    std::vector<std::size_t> walk(scene_.nodes.size(), none);
    for (std::size_t i = 0; i < parents.size(); i++) {
        std::size_t node = i;
        while (node != none && walk[node] == none) {
            walk[node] = i;
            node = parents[node];
        }
        if (node != none && walk[node] == i) {
            throw refusal(label(source_.root, "nodes", "node", node) + ": is its own ancestor "
                                                                       "(node loop)");
        }
    }
    return parents;
}

void scene_loader::place(std::size_t node_index, const transform &world) {
    const tinygltf::Node &node = scene_.nodes[node_index];
    float values[12];
    for (std::size_t i = 0; i < 12; i++) {
        values[i] = finite(world[i]);
        if (!std::isfinite(world[i]) || std::fabs(world[i]) > 3.4028234663852886e38) {
            throw refusal(label(source_.root, "nodes", "node", node_index) + ": its transform is "
                                                                             "not finite");
        }
    }
    if (node.mesh >= 0) {
        // A skinned mesh stands in its bind pose where its own node does.
        girih_gltf_placement placement = {
            static_cast<std::uint32_t>(node.mesh), static_cast<std::uint32_t>(node_index), {}};
        std::copy(values, values + 12, placement.transform);
        model_.placements.push_back(placement);
    }
    if (node.camera >= 0) {
        const tinygltf::Camera &from = scene_.cameras[static_cast<std::size_t>(node.camera)];
        girih_gltf_camera camera = {};
        camera.name =
            model_.keep_name(!from.name.empty()   ? from.name
                             : !node.name.empty() ? node.name
                                                  : "camera " + std::to_string(node.camera));
        camera.perspective = from.type == "perspective";
        if (camera.perspective) {
            camera.vertical_view_angle = finite(from.perspective.yfov);
            camera.aspect = finite(from.perspective.aspectRatio);
            camera.near = finite(from.perspective.znear);
            camera.far = finite(from.perspective.zfar);
        } else {
            camera.x_magnification = finite(from.orthographic.xmag);
            camera.y_magnification = finite(from.orthographic.ymag);
            camera.near = finite(from.orthographic.znear);
            camera.far = finite(from.orthographic.zfar);
        }
        std::copy(values, values + 12, camera.transform);
        model_.cameras.push_back(camera);
    }
}

void scene_loader::load_nodes() {
    const std::vector<std::size_t> parents = node_parents();
    std::vector<std::size_t> roots;
    if (source_.count("scenes") > 0) {
        // Without a default scene the first one is shown, as other viewers do.
        const std::size_t scene_index = source_.root.value("scene", std::size_t{0});
        std::vector<bool> mentioned(parents.size(), false);
        for (const json &element :
             source_.root["scenes"][scene_index].value("nodes", json::array())) {
            const std::size_t root = element;
            if (parents[root] != none || mentioned[root]) {
                throw refusal("scene " + std::to_string(scene_index) + ": " +
                              label(source_.root, "nodes", "node", root) +
                              (mentioned[root] ? " is listed twice" : " is no root node"));
            }
            mentioned[root] = true;
            roots.push_back(root);
        }
    } else {
        for (std::size_t i = 0; i < parents.size(); i++) {
            if (parents[i] == none) {
                roots.push_back(i);
            }
        }
    }
    std::vector<std::pair<std::size_t, transform>>
        open; // nodes to visit, below their parents' transforms
    for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
        open.emplace_back(*root, identity);
    }
    while (!open.empty()) {
        const auto [node_index, parent] = open.back();
        open.pop_back();
        const tinygltf::Node &node = scene_.nodes[node_index];
        const transform world = product(parent, local_transform(node));
        place(node_index, world);
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
            open.emplace_back(static_cast<std::size_t>(*child), world);
        }
    }
    const bool any_mesh_placed =
        std::any_of(scene_.nodes.begin(), scene_.nodes.end(),
                    [](const tinygltf::Node &node) { return node.mesh >= 0; });
    if (!any_mesh_placed && !model_.meshes.empty()) {
        warn_("no node places a mesh: every mesh is drawn once, untransformed");
        for (std::uint32_t m = 0; m < model_.contents.mesh_count; m++) {
            model_.placements.push_back(
                {m, GIRIH_GLTF_NO_NODE, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}});
        }
    }
}

std::int32_t scene_loader::decoded_image(std::size_t image_index) {
    const auto known = decoded_.find(image_index);
    if (known != decoded_.end()) {
        return known->second;
    }
    std::int32_t &result = decoded_[image_index] = -1;
    const bytes &file = model_.image_files[image_index];
    if (file.empty()) {
        return result; // its reader has warned already
    }
    // glTF knows two formats; stb's decoders for others are not for files from strangers.
    const bool png = file.size() > 8 && std::memcmp(file.data(), "\x89PNG\r\n\x1a\n", 8) == 0;
    const bool jpeg = file.size() > 3 && std::memcmp(file.data(), "\xff\xd8\xff", 3) == 0;
    std::string reason = "neither PNG nor JPEG";
    int width = 0, height = 0, channels = 0;
    if ((png || jpeg) && file.size() <= INT_MAX) {
        const int size = static_cast<int>(file.size());
        stbi_uc *pixels = nullptr;
        if (stbi_info_from_memory(file.data(), size, &width, &height, &channels) != 0 &&
            std::int64_t{width} * height <= greatest_pixel_count) {
            pixels = stbi_load_from_memory(file.data(), size, &width, &height, &channels, 4);
        }
        if (pixels != nullptr) {
            model_.pixels.emplace_back(pixels, stbi_image_free);
            model_.images.push_back(
                {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), pixels});
            result = static_cast<std::int32_t>(model_.images.size() - 1);
            return result;
        }
        const char *failure = stbi_failure_reason();
        reason = failure == nullptr ? "damaged" : failure;
    }
    warn_(label(source_.root, "images", "image", image_index) + ": cannot be decoded (" + reason +
          "), materials are drawn without it");
    return result;
}

girih_gltf_wrap wrap_mode(int value) {
    return value == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? GIRIH_GLTF_WRAP_CLAMP
           : value == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? GIRIH_GLTF_WRAP_MIRROR
                                                            : GIRIH_GLTF_WRAP_REPEAT;
}

girih_gltf_texture scene_loader::texture_use(int index, int texcoord,
                                             const tinygltf::ExtensionMap &extensions,
                                             const char *material) {
    girih_gltf_texture result = {};
    result.image = -1;
    result.scale[0] = result.scale[1] = 1.0f;
    if (index < 0) {
        return result;
    }
    const tinygltf::Texture &texture = scene_.textures[static_cast<std::size_t>(index)];
    result.texcoord = static_cast<std::uint32_t>(texcoord);
    if (texture.source >= 0) {
        result.image = decoded_image(static_cast<std::size_t>(texture.source));
    } else {
        warn_("material '" + std::string(material) +
              "': its texture has no PNG or JPEG image, it is drawn without");
    }
    if (texture.sampler >= 0) {
        const tinygltf::Sampler &sampler =
            scene_.samplers[static_cast<std::size_t>(texture.sampler)];
        result.wrap_s = wrap_mode(sampler.wrapS);
        result.wrap_t = wrap_mode(sampler.wrapT);
        result.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    const auto transformed = extensions.find("KHR_texture_transform");
    if (transformed == extensions.end()) {
        return result;
    }
    const tinygltf::Value &change = transformed->second;
    for (int c = 0; c < 2; c++) {
        if (change.Has("offset")) {
            result.offset[c] = finite(change.Get("offset").Get(c).GetNumberAsDouble());
        }
        if (change.Has("scale")) {
            result.scale[c] = finite(change.Get("scale").Get(c).GetNumberAsDouble());
        }
    }
    if (change.Has("rotation")) {
        result.rotation = finite(change.Get("rotation").GetNumberAsDouble());
    }
    if (change.Has("texCoord")) {
        result.texcoord = static_cast<std::uint32_t>(change.Get("texCoord").GetNumberAsInt());
    }
    return result;
}

void scene_loader::load_materials() {
    for (std::size_t i = 0; i < scene_.materials.size(); i++) {
        const tinygltf::Material &from = scene_.materials[i];
        girih_gltf_material material = {};
        material.name =
            model_.keep_name(from.name.empty() ? "material " + std::to_string(i) : from.name);
        for (std::size_t c = 0; c < 4; c++) {
            material.base_color[c] =
                clamped(from.pbrMetallicRoughness.baseColorFactor[c], 0.0, 1.0);
        }
        for (std::size_t c = 0; c < 3; c++) {
            material.emissive[c] = clamped(from.emissiveFactor[c], 0.0, 1.0);
        }
        material.metallic = clamped(from.pbrMetallicRoughness.metallicFactor, 0.0, 1.0);
        material.roughness = clamped(from.pbrMetallicRoughness.roughnessFactor, 0.0, 1.0);
        material.alpha_mode = from.alphaMode == "MASK"    ? GIRIH_GLTF_ALPHA_MASK
                              : from.alphaMode == "BLEND" ? GIRIH_GLTF_ALPHA_BLEND
                                                          : GIRIH_GLTF_ALPHA_OPAQUE;
        material.alpha_cutoff = finite(from.alphaCutoff);
        material.double_sided = from.doubleSided;
        material.unlit = from.extensions.count("KHR_materials_unlit") != 0;
        const tinygltf::TextureInfo &base = from.pbrMetallicRoughness.baseColorTexture;
        const tinygltf::NormalTextureInfo &normal = from.normalTexture;
        material.base_color_texture =
            texture_use(base.index, base.texCoord, base.extensions, material.name);
        material.normal_texture =
            texture_use(normal.index, normal.texCoord, normal.extensions, material.name);
        material.normal_scale = finite(normal.scale);
        model_.materials.push_back(material);
    }
}

void scene_loader::load() {
    load_nodes();
    load_materials();
    girih_gltf_contents &contents = model_.contents;
    contents.placement_count = static_cast<std::uint32_t>(model_.placements.size());
    contents.placements = model_.placements.data();
    contents.material_count = static_cast<std::uint32_t>(model_.materials.size());
    contents.materials = model_.materials.data();
    contents.image_count = static_cast<std::uint32_t>(model_.images.size());
    contents.images = model_.images.data();
    contents.camera_count = static_cast<std::uint32_t>(model_.cameras.size());
    contents.cameras = model_.cameras.data();
}

} // namespace

void load_image_files(girih_gltf_model &model, document &source, const warner &warn) {
    for (std::size_t i = 0; i < source.count("images"); i++) {
        const json &image = source.root["images"][i];
        const std::string where = label(source.root, "images", "image", i);
        model.image_files.emplace_back();
        bytes &file = model.image_files.back();
        if (image.contains("bufferView")) {
            const document::span view = source.view(image["bufferView"]);
            file.assign(view.data, view.data + view.size);
        } else if (image.contains("uri")) {
            try {
                file = source.fetch(image["uri"].get_ref<const std::string &>(), where);
            } catch (const refusal &failure) {
                warn(std::string(failure.what()) + "; materials are drawn without it");
            }
        } else if (!image.contains("extensions")) {
            warn(where + ": has neither a uri nor a buffer view; materials are drawn without it");
        }
    }
}

void load_scene(girih_gltf_model &model, const document &source, const warner &warn) {
    scene_loader(model, source, warn).load();
}

} // namespace girih_gltf
