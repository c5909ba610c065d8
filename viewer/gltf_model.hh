// What the parts of the glTF loader share: the parsed document, its checks, and the model behind
// the C interface of gltf.h. A file is refused by throwing `refusal`, which only gltf.cc catches.
//
// Who reads what: the container, the JSON and every number that leads into a buffer are read and
// checked here, because tinygltf takes both on trust; tinygltf then reads the description of the
// scene (nodes, cameras, materials, textures, samplers) out of the checked document.
#ifndef GIRIH_VIEWER_GLTF_MODEL_HH
#define GIRIH_VIEWER_GLTF_MODEL_HH

#include "gltf.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace girih_gltf {

using json = nlohmann::json;
using bytes = std::vector<std::uint8_t>;

// The file is wrong, or asks for what is not supported; what() is the one line for the user.
struct refusal : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Control characters, line breaks among them, become spaces: names in a file can hold anything.
std::string one_line(std::string text);

// Hands one line at a time to the caller's function, which may be NULL.
class warner {
  public:
    warner(void (*function)(void *, const char *), void *user) : function_(function), user_(user) {
    }
    void operator()(const std::string &line) const {
        if (function_ != nullptr) {
            function_(user_, one_line(line).c_str());
        }
    }

  private:
    void (*function_)(void *, const char *);
    void *user_;
};

// The whole of a regular file; refuses anything else, since a FIFO or a device may never end.
bytes read_regular_file(const std::string &path);

// A glTF document whose properties have the types and whose indices the targets that glTF 2.0 asks
// for (check_document), beside the bytes its buffers refer to.
class document {
  public:
    explicit document(const std::string &path);

    json root;

    // A view's bytes. Refuses a view that reaches outside its buffer and a buffer that cannot be
    // had.
    struct span {
        const std::uint8_t *data;
        std::size_t size;
        std::size_t stride; // 0: tightly packed
    };
    span view(std::size_t index);

    // Bytes of a buffer; where names who asks for them in a refusal.
    span range(std::size_t buffer_index, std::uint64_t offset, std::uint64_t size,
               const std::string &where);

    // Makes bytes one more buffer of the document; returns its index.
    std::size_t add_buffer(bytes data);

    // What a URI of this document refers to; where names its owner in a refusal.
    bytes fetch(const std::string &uri, const std::string &where) const;

    std::size_t count(const char *array) const;

  private:
    void read_glb();
    span buffer(std::size_t index);

    std::string folder_; // "" or ending in '/'
    bytes file_;
    std::size_t json_offset_ = 0, json_size_ = 0;
    std::size_t binary_offset_ = 0, binary_size_ = 0;
    bool has_binary_ = false;
    std::map<std::size_t, bytes> buffers_; // fetched when first used
};

// Refuses a document with a property of the wrong type, a missing one or an unresolved index.
// Integers written as 2.0 become integers.
void check_document(json &root);

// Replaces compressed primitives and buffer views by what they hold.
void decode_compressed(document &source); // gltf_decode.cc

// Refuses a required extension that is not understood; warns of optional ones that change the
// picture.
void check_extensions(const json &root, const warner &warn);

// --- Accessors (gltf_accessor.cc) ---

enum component_type : unsigned {
    type_i8 = 5120,
    type_u8 = 5121,
    type_i16 = 5122,
    type_u16 = 5123,
    type_u32 = 5125,
    type_f32 = 5126
};

// An accessor without data is all zeros, so that nothing in the file bounds its count.
constexpr std::uint64_t greatest_zero_count = 1u << 24;

// Refuses an unknown type; where names its owner.
unsigned component_size(std::uint64_t type, const std::string &where);

// How many components an element has; 0 for matrices other than 4x4 floats, which nothing that
// girih keeps uses.
unsigned component_count(const json &accessor);

// count elements of element_size bytes in a view, a whole number of strides apart.
struct elements {
    const std::uint8_t *data;
    std::size_t stride;
};

// Refuses elements that reach outside the view; where names their owner.
elements locate(document &source, std::size_t view_index, std::uint64_t offset, std::uint64_t count,
                std::size_t element_size, const std::string &where);

std::uint32_t read_index(const std::uint8_t *from, std::uint64_t type);

// An accessor's elements as floats, sparse values applied. Decoded once for all its users.
const std::vector<float> &accessor_values(girih_gltf_model &model, document &source,
                                          std::size_t accessor_index, bool always_normalized);

// How many bytes an element takes, and how far apart two are without a stride. Both 0 where its
// types are unknown.
struct element_layout {
    std::uint64_t size, distance;
};

element_layout layout_of(const json &accessor); // gltf_check.cc

// An accessor's elements as they are in the file, sparse values applied, each at a multiple of
// `alignment` bytes.
bytes accessor_bytes(document &source, std::size_t accessor_index, std::size_t alignment);

// A number of the JSON as a float, never infinite.
inline float finite(double value) {
    constexpr double greatest = std::numeric_limits<float>::max();
    return static_cast<float>(std::fmin(std::fmax(value, -greatest), greatest));
}

// "mesh 3 'door'": how messages name an element of a top-level array.
std::string label(const json &root, const char *array, const char *kind, std::size_t index);

} // namespace girih_gltf

struct girih_gltf_model {
    std::unique_ptr<girih_gltf::document> source; // which girih_gltf_write starts from

    // The encoded bytes of every image, as in the source; empty where they could not be read.
    std::vector<girih_gltf::bytes> image_files;

    // Decoded accessors are shared by the primitives that refer to them, as in the file. Deques and
    // maps keep their elements where they are, so the C structures can point into them.
    std::map<std::pair<std::size_t, bool>, std::vector<float>> values;
    std::deque<std::vector<std::uint32_t>> indices;
    std::deque<std::string> names;
    std::deque<std::vector<girih_gltf_attribute>> attributes;
    std::deque<std::vector<float>> floats;
    std::deque<std::vector<const char *>> name_lists;
    std::deque<std::vector<girih_gltf_morph_target>> targets;
    std::deque<std::vector<girih_gltf_primitive>> primitives;
    std::vector<std::vector<std::size_t>>
        source_primitives; // [mesh][primitive]: its index in the file

    std::vector<girih_gltf_mesh> meshes;
    std::vector<girih_gltf_placement> placements;
    std::vector<girih_gltf_material> materials;
    std::vector<girih_gltf_image> images;
    std::vector<std::unique_ptr<std::uint8_t, void (*)(void *)>> pixels;
    std::vector<girih_gltf_camera> cameras;
    std::vector<girih_gltf_node> nodes;
    std::vector<std::uint32_t> node_order;
    std::deque<std::vector<std::array<float, 12>>> matrices;
    std::vector<girih_gltf_skin> skins;
    std::deque<std::vector<girih_gltf_sampler>> samplers;
    std::deque<std::vector<girih_gltf_channel>> channels;
    std::vector<girih_gltf_animation> animations;
    girih_gltf_contents contents = {};

    const char *keep_name(std::string name);
};

namespace girih_gltf {

void load_geometry(girih_gltf_model &model, document &source,
                   const warner &warn); // gltf_geometry.cc
void load_image_files(girih_gltf_model &model, document &source,
                      const warner &warn); // gltf_scene.cc
void load_scene(girih_gltf_model &model, const document &source,
                const warner &warn); // gltf_scene.cc
void load_animations(girih_gltf_model &model, document &source,
                     const warner &warn); // gltf_animation.cc

// The element's name, or "kind N".
std::string name_or_number(const json &element, const char *kind, std::size_t index);

// Throws refusal where the file cannot be written.
void write_model(const girih_gltf_model &model, const girih_gltf_refined_primitive *const *refined,
                 const char *path, const warner &warn); // gltf_write.cc

} // namespace girih_gltf

#endif
