// Accessors: every range is checked before a byte of it is read, since neither the file nor
// tinygltf promises any. glTF 2.0, section 3.6.2.
#include "gltf_model.hh"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace girih_gltf {
namespace {

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

} // namespace

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

unsigned component_count(const json &accessor) {
    const std::string &type = accessor["type"].get_ref<const std::string &>();
    if (type == "SCALAR") {
        return 1;
    }
    if (type == "MAT4" && accessor["componentType"] == type_f32) {
        return 16;
    }
    return type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
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

namespace {

// Calls replace(element, its new value's bytes) for the sparse values of an accessor, if any.
template <typename Replace>
void for_sparse(document &source, const json &accessor, std::size_t element_size,
                const std::string &where, Replace replace) {
    if (!accessor.contains("sparse")) {
        return;
    }
    const json &sparse = accessor["sparse"], &indices = sparse["indices"];
    const std::uint64_t count = sparse["count"], index_type = indices["componentType"];
    if (index_type != type_u8 && index_type != type_u16 && index_type != type_u32) {
        throw refusal(where + ": sparse indices must be unsigned integers");
    }
    const elements positions =
        locate(source, indices["bufferView"], indices.value("byteOffset", std::uint64_t{0}), count,
               component_size(index_type, where), where + ", sparse indices");
    const elements replacements = locate(source, sparse["values"]["bufferView"],
                                         sparse["values"].value("byteOffset", std::uint64_t{0}),
                                         count, element_size, where + ", sparse values");
    const std::uint64_t element_count = accessor["count"];
    for (std::size_t i = 0; i < count; i++) {
        const std::uint32_t target = read_index(positions.data + i * positions.stride, index_type);
        if (target >= element_count) {
            throw refusal(where + ": sparse index " + std::to_string(target) +
                          ", but there are only " + std::to_string(element_count) + " elements");
        }
        replace(std::size_t{target}, replacements.data + i * replacements.stride);
    }
}

} // namespace

const std::vector<float> &accessor_values(girih_gltf_model &model, document &source,
                                          std::size_t accessor_index, bool always_normalized) {
    const std::pair<std::size_t, bool> key(accessor_index, always_normalized);
    const auto known = model.values.find(key);
    if (known != model.values.end()) {
        return known->second;
    }
    const json &accessor = source.root["accessors"][accessor_index];
    const std::string where = label(source.root, "accessors", "accessor", accessor_index);
    const std::uint64_t type = accessor["componentType"], count = accessor["count"];
    const unsigned size = component_size(type, where), components = component_count(accessor);
    const bool normalized = always_normalized || accessor.value("normalized", false);
    const std::size_t element_size = std::size_t{size} * components;

    elements base = {};
    if (accessor.contains("bufferView")) {
        base = locate(source, accessor["bufferView"],
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
    for_sparse(source, accessor, element_size, where,
               [&](std::size_t target, const std::uint8_t *value) {
                   for (unsigned c = 0; c < components; c++) {
                       result[target * components + c] =
                           read_component(value + c * size, type, normalized);
                   }
               });
    return model.values.emplace(key, std::move(result)).first->second;
}

bytes accessor_bytes(document &source, std::size_t accessor_index, std::size_t alignment) {
    const json &accessor = source.root["accessors"][accessor_index];
    const std::string where = label(source.root, "accessors", "accessor", accessor_index);
    const element_layout element = layout_of(accessor);
    const std::uint64_t count = accessor["count"];
    if (element.size == 0) {
        throw refusal(where + ": unknown type");
    }
    const std::size_t size = element.size,
                      distance = (element.distance + alignment - 1) / alignment * alignment;
    elements base = {};
    if (accessor.contains("bufferView")) {
        base = locate(source, accessor["bufferView"],
                      accessor.value("byteOffset", std::uint64_t{0}), count, size, where);
        // A matrix may be shorter than the way to the next one (check_ranges knows of both).
        base.stride = std::max<std::size_t>(base.stride, element.distance);
    } else if (count > greatest_zero_count) {
        throw refusal(where + ": " + std::to_string(count) + " elements without data");
    }
    bytes result(count * distance);
    for (std::size_t i = 0; base.data != nullptr && i < count; i++) {
        std::memcpy(result.data() + i * distance, base.data + i * base.stride, size);
    }
    for_sparse(source, accessor, size, where, [&](std::size_t target, const std::uint8_t *value) {
        std::memcpy(result.data() + target * distance, value, size);
    });
    return result;
}

} // namespace girih_gltf
