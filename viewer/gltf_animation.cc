// Skins and animations: glTF 2.0, sections 3.7.3.3 and 3.11.
#include "gltf_model.hh"

#include <algorithm>
#include <cmath>

namespace girih_gltf {
namespace {

class animation_loader {
  public:
    animation_loader(girih_gltf_model &model, document &source, const warner &warn)
        : model_(model), source_(source), warn_(warn) {
    }

    void load();

  private:
    void load_skin(std::size_t index);
    void check_joints(const girih_gltf_node &node, const std::string &where) const;
    bool load_channel(const json &description, girih_gltf_channel &channel) const;
    void load_sampler(const json &description, const girih_gltf_channel &channel,
                      const std::string &where, girih_gltf_sampler &sampler);
    void load_animation(std::size_t index);

    girih_gltf_model &model_;
    document &source_;
    const warner &warn_;
};

void animation_loader::load_skin(std::size_t index) {
    const json &description = source_.root["skins"][index];
    const std::string where = label(source_.root, "skins", "skin", index);
    model_.indices.push_back(description["joints"].get<std::vector<std::uint32_t>>());
    const std::vector<std::uint32_t> &joints = model_.indices.back();
    if (joints.empty()) {
        throw refusal(where + ": has no joints");
    }
    model_.matrices.emplace_back(joints.size(), // the identity, where the file has none
                                 std::array<float, 12>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    std::vector<std::array<float, 12>> &matrices = model_.matrices.back();
    if (description.contains("inverseBindMatrices")) {
        const std::size_t accessor_index = description["inverseBindMatrices"];
        const json &accessor = source_.root["accessors"][accessor_index];
        const std::uint64_t count = accessor["count"];
        if (component_count(accessor) != 16 || count < joints.size()) {
            throw refusal(where + ": its " + std::to_string(joints.size()) +
                          " joints need as many inverse bind matrices, MAT4 of floats; accessor " +
                          std::to_string(accessor_index) + " has not");
        }
        const std::vector<float> &columns = accessor_values(model_, source_, accessor_index, false);
        for (std::size_t j = 0; j < joints.size(); j++) {
            for (std::size_t e = 0; e < 12; e++) {
                matrices[j][e] = columns[16 * j + 4 * (e % 4) + e / 4];
                if (!std::isfinite(matrices[j][e])) {
                    throw refusal(where + ": inverse bind matrix " + std::to_string(j) +
                                  " is not finite");
                }
            }
        }
    }
    girih_gltf_skin skin = {};
    skin.name = model_.keep_name(name_or_number(description, "skin", index));
    skin.joint_count = static_cast<std::uint32_t>(joints.size());
    skin.joints = joints.data();
    skin.inverse_bind_matrices = reinterpret_cast<const float(*)[12]>(matrices.data());
    skin.skeleton = description.value("skeleton", std::uint32_t{GIRIH_GLTF_NO_NODE});
    model_.skins.push_back(skin);
}

// Every joint of the mesh must be one of the skin's.
void animation_loader::check_joints(const girih_gltf_node &node, const std::string &where) const {
    const girih_gltf_skin &skin = model_.skins[static_cast<std::size_t>(node.skin)];
    const girih_gltf_mesh &mesh = model_.meshes[static_cast<std::size_t>(node.mesh)];
    for (std::uint32_t p = 0; p < mesh.primitive_count; p++) {
        const girih_gltf_primitive &primitive = mesh.primitives[p];
        const std::size_t count = std::size_t{primitive.vertex_count} * primitive.influence_count;
        for (std::size_t i = 0; i < count; i++) {
            if (primitive.joints[i] >= skin.joint_count) {
                throw refusal(where + ": vertex " + std::to_string(i / primitive.influence_count) +
                              " of mesh '" + mesh.name + "', primitive " + std::to_string(p) +
                              ", follows joint " + std::to_string(primitive.joints[i]) +
                              ", but skin '" + skin.name + "' has only " +
                              std::to_string(skin.joint_count));
            }
        }
    }
}

// False where there is nothing for it to move.
bool animation_loader::load_channel(const json &description, girih_gltf_channel &channel) const {
    static const char *const paths[] = {"translation", "rotation", "scale", "weights"};
    const json &target = description["target"];
    const auto path = std::find(std::begin(paths), std::end(paths),
                                target["path"].get_ref<const std::string &>());
    if (path == std::end(paths) || !target.contains("node")) {
        return false; // an extension's, as KHR_animation_pointer's
    }
    channel.sampler = description["sampler"];
    channel.node = target["node"];
    channel.path = static_cast<girih_gltf_path>(path - paths);
    const girih_gltf_node &node = model_.nodes[channel.node];
    return channel.path == GIRIH_GLTF_WEIGHTS ? node.weights != nullptr : !node.local.has_matrix;
}

void animation_loader::load_sampler(const json &description, const girih_gltf_channel &channel,
                                    const std::string &where, girih_gltf_sampler &sampler) {
    const std::string interpolation = description.value("interpolation", "LINEAR");
    sampler.interpolation = interpolation == "STEP"          ? GIRIH_GLTF_STEP
                            : interpolation == "CUBICSPLINE" ? GIRIH_GLTF_CUBIC_SPLINE
                                                             : GIRIH_GLTF_LINEAR;
    if (interpolation != "STEP" && interpolation != "CUBICSPLINE" && interpolation != "LINEAR") {
        throw refusal(where + ": its interpolation '" + interpolation.substr(0, 40) +
                      "' is none of STEP, LINEAR and CUBICSPLINE");
    }
    const std::size_t input_index = description["input"], output_index = description["output"];
    const json &input = source_.root["accessors"][input_index];
    const json &output = source_.root["accessors"][output_index];
    if (component_count(input) != 1 || input["componentType"] != type_f32) {
        throw refusal(where + ": the times of its keys must be float scalars");
    }
    std::uint32_t components = channel.path == GIRIH_GLTF_ROTATION ? 4 : 3,
                  per_element = components;
    if (channel.path == GIRIH_GLTF_WEIGHTS) {
        components =
            model_.meshes[static_cast<std::size_t>(model_.nodes[channel.node].mesh)].target_count;
        per_element = 1;
    }
    const std::uint64_t key_count = input["count"], value_count = output["count"];
    const std::uint64_t wanted = key_count * (components / per_element) *
                                 (sampler.interpolation == GIRIH_GLTF_CUBIC_SPLINE ? 3 : 1);
    if (component_count(output) != per_element || value_count != wanted) {
        throw refusal(where + ": its " + std::to_string(key_count) + " keys need " +
                      std::to_string(wanted) + " elements of " + std::to_string(per_element) +
                      " components each, accessor " + std::to_string(output_index) + " has " +
                      std::to_string(value_count) + " of " +
                      std::to_string(component_count(output)));
    }
    const std::vector<float> &times = accessor_values(model_, source_, input_index, false);
    // Only normalised integers are allowed; some exporters forget to say so.
    const std::vector<float> &values = accessor_values(model_, source_, output_index, true);
    for (std::size_t k = 0; k < times.size(); k++) {
        if (!std::isfinite(times[k]) || (k > 0 && times[k] < times[k - 1])) {
            throw refusal(where + ": the time of key " + std::to_string(k) +
                          " is before that of its predecessor, or not finite");
        }
    }
    if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); })) {
        throw refusal(where + ": a value is not finite");
    }
    sampler.key_count = static_cast<std::uint32_t>(times.size());
    sampler.times = times.data();
    sampler.components = components;
    sampler.values = values.data();
}

void animation_loader::load_animation(std::size_t index) {
    const json &description = source_.root["animations"][index];
    const std::string where = label(source_.root, "animations", "animation", index);
    const json &from_samplers = description["samplers"];
    std::vector<girih_gltf_sampler> samplers(from_samplers.size());
    std::vector<girih_gltf_channel> channels;
    for (std::size_t c = 0; c < description["channels"].size(); c++) {
        const json &from = description["channels"][c];
        const std::uint64_t sampler_index = from["sampler"];
        if (sampler_index >= samplers.size()) {
            throw refusal(where + ", channel " + std::to_string(c) + ": its sampler is " +
                          std::to_string(sampler_index) + ", but there are only " +
                          std::to_string(samplers.size()));
        }
        girih_gltf_channel channel = {};
        if (load_channel(from, channel)) {
            load_sampler(from_samplers[channel.sampler], channel,
                         where + ", sampler " + std::to_string(sampler_index),
                         samplers[channel.sampler]);
            channels.push_back(channel);
        }
    }
    if (channels.size() < description["channels"].size()) {
        warn_(where + ": " + std::to_string(description["channels"].size() - channels.size()) +
              " of its " + std::to_string(description["channels"].size()) +
              " channels are ignored: their targets are none of translation, rotation, scale and "
              "weights of a node that has such");
    }
    girih_gltf_animation animation = {};
    animation.name = model_.keep_name(name_or_number(description, "animation", index));
    for (const girih_gltf_channel &channel : channels) {
        const girih_gltf_sampler &sampler = samplers[channel.sampler];
        const float first = sampler.times[0], last = sampler.times[sampler.key_count - 1];
        const bool is_first = &channel == &channels.front();
        animation.start = is_first ? first : std::min(animation.start, first);
        animation.end = is_first ? last : std::max(animation.end, last);
    }
    model_.samplers.push_back(std::move(samplers));
    animation.sampler_count = static_cast<std::uint32_t>(model_.samplers.back().size());
    animation.samplers = model_.samplers.back().data();
    model_.channels.push_back(std::move(channels));
    animation.channel_count = static_cast<std::uint32_t>(model_.channels.back().size());
    animation.channels = model_.channels.back().data();
    model_.animations.push_back(animation);
}

void animation_loader::load() {
    for (std::size_t i = 0; i < source_.count("skins"); i++) {
        load_skin(i);
    }
    for (std::size_t i = 0; i < model_.nodes.size(); i++) {
        if (model_.nodes[i].skin >= 0) {
            check_joints(model_.nodes[i], label(source_.root, "nodes", "node", i));
        }
    }
    for (std::size_t i = 0; i < source_.count("animations"); i++) {
        load_animation(i);
    }
    girih_gltf_contents &contents = model_.contents;
    contents.skin_count = static_cast<std::uint32_t>(model_.skins.size());
    contents.skins = model_.skins.data();
    contents.animation_count = static_cast<std::uint32_t>(model_.animations.size());
    contents.animations = model_.animations.data();
}

} // namespace

void load_animations(girih_gltf_model &model, document &source, const warner &warn) {
    animation_loader(model, source, warn).load();
}

} // namespace girih_gltf
