// The scene around the meshes: node transforms, cameras, materials and their textures, as tinygltf
// reads them from the checked document.
#include "gltf_model.hh"
#include "node_transform.h"

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

using transform = std::array<double, 12>; // node_transform.h

float clamped(double value, double low, double high) {
    return static_cast<float>(std::fmin(std::fmax(value, low), high));
}

class scene_loader {
  public:
    scene_loader(girih_gltf_model &model, const document &source, const warner &warn);
    void load();

  private:
    std::vector<std::size_t> node_parents() const;
    const float *node_weights(const tinygltf::Node &node, const std::string &where);
    void load_nodes(const std::vector<std::size_t> &parents);
    std::vector<transform> node_worlds() const;
    void place(std::size_t node_index, const transform &world);
    void load_scene();
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

// The morph weights that a node has in the file, its own or its mesh's.
const float *scene_loader::node_weights(const tinygltf::Node &node, const std::string &where) {
    const girih_gltf_mesh &mesh = model_.meshes[static_cast<std::size_t>(node.mesh)];
    if (node.weights.empty()) {
        return mesh.target_count > 0 ? mesh.weights : nullptr;
    }
    if (node.weights.size() != mesh.target_count) {
        throw refusal(where + ": has " + std::to_string(node.weights.size()) +
                      " weights, but its mesh has " + std::to_string(mesh.target_count) +
                      " morph targets");
    }
    std::vector<float> weights;
    for (const double weight : node.weights) {
        weights.push_back(finite(weight));
    }
    model_.floats.push_back(std::move(weights));
    return model_.floats.back().data();
}

void scene_loader::load_nodes(const std::vector<std::size_t> &parents) {
    for (std::size_t i = 0; i < scene_.nodes.size(); i++) {
        const tinygltf::Node &from = scene_.nodes[i];
        girih_gltf_node node = {};
        node.name = model_.keep_name(name_or_number(source_.root["nodes"][i], "node", i));
        node.parent =
            parents[i] == none ? GIRIH_GLTF_NO_NODE : static_cast<std::uint32_t>(parents[i]);
        node.mesh = from.mesh;
        node.skin = from.mesh < 0 ? -1 : from.skin;
        node.camera = from.camera;
        girih_gltf_transform &local = node.local;
        local.rotation[3] = local.scale[0] = local.scale[1] = local.scale[2] = 1.0;
        std::copy(from.translation.begin(), from.translation.end(), local.translation);
        std::copy(from.rotation.begin(), from.rotation.end(), local.rotation);
        std::copy(from.scale.begin(), from.scale.end(), local.scale);
        local.has_matrix = !from.matrix.empty();
        for (std::size_t e = 0; e < 12 && local.has_matrix; e++) {
            local.matrix[e] = from.matrix[4 * (e % 4) + e / 4];
        }
        if (from.mesh >= 0) {
            node.weights = node_weights(from, label(source_.root, "nodes", "node", i));
        }
        model_.nodes.push_back(node);
    }
    // Children behind parents: a list that grows while it is walked.
    std::vector<std::uint32_t> &order = model_.node_order;
    for (std::uint32_t i = 0; i < parents.size(); i++) {
        if (parents[i] == none) {
            order.push_back(i);
        }
    }
    for (std::size_t at = 0; at < order.size(); at++) {
        for (const int child : scene_.nodes[order[at]].children) {
            order.push_back(static_cast<std::uint32_t>(child));
        }
    }
}

std::vector<transform> scene_loader::node_worlds() const {
    std::vector<transform> worlds(model_.nodes.size());
    for (const std::uint32_t i : model_.node_order) {
        const girih_gltf_node &node = model_.nodes[i];
        transform local;
        girih_node_matrix(&node.local, local.data());
        if (node.parent == GIRIH_GLTF_NO_NODE) {
            worlds[i] = local;
        } else {
            girih_matrix_product(worlds[node.parent].data(), local.data(), worlds[i].data());
        }
    }
    return worlds;
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
        camera.node = static_cast<std::uint32_t>(node_index);
        std::copy(values, values + 12, camera.transform);
        model_.cameras.push_back(camera);
    }
}

void scene_loader::load_scene() {
    const std::vector<std::size_t> parents = node_parents();
    load_nodes(parents);
    const std::vector<transform> worlds = node_worlds();
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
    std::vector<std::size_t> open(roots.rbegin(),
                                  roots.rend()); // nodes to visit, the next one last
    while (!open.empty()) {
        const std::size_t node_index = open.back();
        open.pop_back();
        place(node_index, worlds[node_index]);
        const std::vector<int> &children = scene_.nodes[node_index].children;
        open.insert(open.end(), children.rbegin(), children.rend());
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
    load_scene();
    load_materials();
    girih_gltf_contents &contents = model_.contents;
    contents.node_count = static_cast<std::uint32_t>(model_.nodes.size());
    contents.nodes = model_.nodes.data();
    contents.node_order = model_.node_order.data();
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
