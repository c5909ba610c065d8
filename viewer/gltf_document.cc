// Files, the GLB container, URIs, buffers and buffer views of a glTF document (glTF 2.0, sections
// 2.7, 3.6.1 and 4).
#include "gltf_model.hh"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace girih_gltf {
namespace {

// Deeper documents than any exporter writes are refused: copying and writing JSON recurse.
constexpr unsigned greatest_depth = 128;

constexpr std::uint32_t magic_gltf = 0x46546C67, chunk_json = 0x4E4F534A, chunk_binary = 0x004E4942;

struct file_descriptor {
    int value;
    ~file_descriptor() {
        if (value >= 0) {
            close(value);
        }
    }
};

std::uint32_t read_u32(const bytes &data, std::size_t offset) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4; i++) {
        value |= static_cast<std::uint32_t>(data[offset + i]) << (8 * i);
    }
    return value;
}

void check_depth(const std::uint8_t *text, std::size_t size) {
    unsigned depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < size; i++) {
        const std::uint8_t c = text[i];
        if (in_string) {
            if (c == '\\') {
                i++;
            } else if (c == '"') {
                in_string = false;
            }
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > greatest_depth) {
                throw refusal("the JSON is nested more than " + std::to_string(greatest_depth) +
                              " levels deep");
            }
        } else if ((c == ']' || c == '}') && depth > 0) {
            depth--;
        }
    }
}

int hexadecimal_digit(char c) {
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    if (c >= 'a' && c <= 'f') {
        return c - 'a' + 10;
    }
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

std::string percent_decoded(const std::string &text) {
    std::string decoded;
    decoded.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); i++) {
        const int high =
            text[i] == '%' && i + 2 < text.size() ? hexadecimal_digit(text[i + 1]) : -1;
        const int low = high >= 0 ? hexadecimal_digit(text[i + 2]) : -1;
        if (low >= 0) {
            decoded.push_back(static_cast<char>(high * 16 + low));
            i += 2;
        } else {
            decoded.push_back(text[i]);
        }
    }
    return decoded;
}

// RFC 4648; padding may be missing, anything else that is not base64 is refused.
bytes base64_decoded(const std::string &text, std::size_t start, const std::string &where) {
    std::size_t end = text.size();
    while (end > start && text[end - 1] == '=') {
        end--;
    }
    bytes decoded;
    decoded.reserve((end - start) / 4 * 3 + 2);
    std::uint32_t bits = 0;
    unsigned bit_count = 0;
    for (std::size_t i = start; i < end; i++) {
        const char c = text[i];
        std::uint32_t value = 0;
        if (c >= 'A' && c <= 'Z') {
            value = static_cast<std::uint32_t>(c - 'A');
        } else if (c >= 'a' && c <= 'z') {
            value = static_cast<std::uint32_t>(c - 'a') + 26;
        } else if (c >= '0' && c <= '9') {
            value = static_cast<std::uint32_t>(c - '0') + 52;
        } else if (c == '+') {
            value = 62;
        } else if (c == '/') {
            value = 63;
        } else {
            throw refusal(where + ": the data URI is not base64");
        }
        bits = (bits << 6 | value) & 0xffffff;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            decoded.push_back(static_cast<std::uint8_t>(bits >> bit_count));
        }
    }
    return decoded;
}

bool starts_with_ignoring_case(const std::string &text, const char *prefix) {
    return strncasecmp(text.c_str(), prefix, std::strlen(prefix)) == 0;
}

// The length of "scheme:" in front of a URI, 0 where it is relative (RFC 3986, section 3.1).
std::size_t scheme_length(const std::string &uri) {
    for (std::size_t i = 0; i < uri.size(); i++) {
        const char c = uri[i];
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        const bool other = (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
        if (c == ':') {
            return i > 1 ? i + 1 : 0; // one letter is a drive, or a file named so
        }
        if (!letter && (i == 0 || !other)) {
            return 0;
        }
    }
    return 0;
}

} // namespace

bytes read_regular_file(const std::string &path) {
    if (path.find('\0') != std::string::npos) {
        throw refusal("cannot open a file name with a zero byte in it");
    }
    // O_NONBLOCK: opening a FIFO nobody writes to would wait for ever.
    const file_descriptor file = {open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
    struct stat status;
    if (file.value < 0 || fstat(file.value, &status) != 0) {
        throw refusal("cannot open: " + std::string(std::strerror(errno)));
    }
    if (!S_ISREG(status.st_mode)) {
        throw refusal("cannot read: not a regular file");
    }
    bytes data(static_cast<std::size_t>(status.st_size));
    std::size_t done = 0;
    while (done < data.size()) {
        const ssize_t got = read(file.value, data.data() + done, data.size() - done);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            throw refusal("cannot read: " + std::string(std::strerror(errno)));
        }
        if (got == 0) {
            break;
        }
        done += static_cast<std::size_t>(got);
    }
    data.resize(done);
    return data;
}

std::string label(const json &root, const char *array, const char *kind, std::size_t index) {
    std::string text = std::string(kind) + " " + std::to_string(index);
    const auto elements = root.find(array);
    if (elements != root.end() && index < elements->size()) {
        const auto name = (*elements)[index].find("name");
        if (name != (*elements)[index].end() && name->is_string()) {
            text += " '" + name->get<std::string>().substr(0, 80) + "'";
        }
    }
    return text;
}

std::string name_or_number(const json &element, const char *kind, std::size_t index) {
    const auto name = element.find("name");
    return name != element.end() && name->is_string() ? name->get<std::string>()
                                                      : kind + (" " + std::to_string(index));
}

document::document(const std::string &path) : file_(read_regular_file(path)) {
    const std::size_t slash = path.rfind('/');
    folder_ = slash == std::string::npos ? "" : path.substr(0, slash + 1);

    const bool named_glb =
        path.size() >= 4 && starts_with_ignoring_case(path.substr(path.size() - 4), ".glb");
    std::size_t first =
        file_.size() >= 3 && std::memcmp(file_.data(), "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (first < file_.size() && std::strchr(" \t\r\n", file_[first]) != nullptr &&
           file_[first] != 0) {
        first++;
    }
    if (file_.size() >= 4 && read_u32(file_, 0) == magic_gltf) {
        read_glb();
    } else if (first < file_.size() && file_[first] == '{') {
        json_size_ = file_.size();
    } else if (named_glb) {
        throw refusal("bad GLB header: the file does not begin with 'glTF'");
    } else {
        throw refusal("neither glTF JSON nor GLB");
    }

    const std::uint8_t *text = file_.data() + json_offset_;
    check_depth(text, json_size_);
    try {
        root = json::parse(text, text + json_size_);
    } catch (const json::exception &failure) {
        const std::string reason =
            failure.what(); // "[json.exception.parse_error.101] parse error ..."
        const std::size_t bracket = reason.find("] ");
        throw refusal("not valid JSON: " +
                      (bracket == std::string::npos ? reason : reason.substr(bracket + 2)));
    }
    check_document(root);
}

void document::read_glb() {
    if (file_.size() < 12) {
        throw refusal("bad GLB header: the file ends within it");
    }
    if (read_u32(file_, 4) != 2) {
        throw refusal("bad GLB header: version " + std::to_string(read_u32(file_, 4)) +
                      ", only version 2 is supported");
    }
    if (read_u32(file_, 8) != file_.size()) {
        throw refusal("bad GLB header: it states " + std::to_string(read_u32(file_, 8)) +
                      " bytes, the file has " + std::to_string(file_.size()));
    }
    std::size_t offset = 12;
    for (unsigned chunk = 0; offset < file_.size(); chunk++) {
        const std::string where = "bad GLB chunk " + std::to_string(chunk) + ": ";
        if (file_.size() - offset < 8) {
            throw refusal(where + "the file ends within its header");
        }
        const std::size_t size = read_u32(file_, offset);
        const std::uint32_t type = read_u32(file_, offset + 4);
        offset += 8;
        if (size % 4 != 0) {
            throw refusal(where + "its length " + std::to_string(size) + " is no multiple of 4");
        }
        if (size > file_.size() - offset) {
            throw refusal(where + "it states " + std::to_string(size) + " bytes, " +
                          std::to_string(file_.size() - offset) + " are left");
        }
        if ((chunk == 0) != (type == chunk_json)) {
            throw refusal(where + (chunk == 0 ? "the first one must be JSON" : "a second JSON"));
        }
        if (type == chunk_json) {
            json_offset_ = offset;
            json_size_ = size;
        } else if (type == chunk_binary) {
            if (chunk != 1) {
                throw refusal(where + "the binary chunk must be the second");
            }
            binary_offset_ = offset;
            binary_size_ = size;
            has_binary_ = true;
        }
        offset += size;
    }
    if (json_size_ == 0) {
        throw refusal("bad GLB header: no JSON chunk, or an empty one");
    }
}

std::size_t document::count(const char *array) const {
    const auto elements = root.find(array);
    return elements == root.end() ? 0 : elements->size();
}

bytes document::fetch(const std::string &uri, const std::string &where) const {
    if (starts_with_ignoring_case(uri, "data:")) {
        const std::size_t comma = uri.find(',');
        if (comma == std::string::npos) {
            throw refusal(where + ": the data URI has no comma");
        }
        const bool base64 = comma >= 7 && strncasecmp(uri.c_str() + comma - 7, ";base64", 7) == 0;
        if (base64) {
            return base64_decoded(uri, comma + 1, where);
        }
        const std::string decoded = percent_decoded(uri.substr(comma + 1));
        return bytes(decoded.begin(), decoded.end());
    }
    if (const std::size_t scheme = scheme_length(uri)) {
        throw refusal(where + ": cannot read '" + uri.substr(0, 120) + "': " +
                      uri.substr(0, scheme) + " is not supported, only files and data URIs are");
    }
    // A URI is percent-encoded; some exporters write plain file names, '%' among them.
    const std::string names[] = {percent_decoded(uri), uri};
    std::string reason;
    for (const std::string &name : names) {
        try {
            return read_regular_file(!name.empty() && name[0] == '/' ? name : folder_ + name);
        } catch (const refusal &failure) {
            if (reason.empty()) {
                reason = failure.what();
            }
        }
    }
    throw refusal(where + ": '" + names[0].substr(0, 200) + "': " + reason);
}

document::span document::buffer(std::size_t index) {
    const json &description = root["buffers"][index];
    const std::string where = label(root, "buffers", "buffer", index);
    const std::uint64_t length = description["byteLength"];
    span data = {};
    const auto known = buffers_.find(index);
    if (known != buffers_.end()) {
        data = {known->second.data(), known->second.size(), 0};
    } else if (description.contains("uri")) {
        const bytes &fetched =
            buffers_.emplace(index, fetch(description["uri"].get_ref<const std::string &>(), where))
                .first->second;
        data = {fetched.data(), fetched.size(), 0};
    } else if (index == 0 && has_binary_) {
        data = {file_.data() + binary_offset_, binary_size_, 0};
    } else {
        throw refusal(where + ": has neither a uri nor a GLB binary chunk");
    }
    if (data.size < length) {
        throw refusal(where + ": it states " + std::to_string(length) +
                      " bytes, its data has only " + std::to_string(data.size));
    }
    return data;
}

document::span document::view(std::size_t index) {
    const json &description = root["bufferViews"][index]; // its range was checked when loading
    const span data = buffer(description["buffer"]);
    const std::size_t offset = description.value("byteOffset", std::size_t{0});
    return {data.data + offset, description["byteLength"].get<std::size_t>(),
            description.value("byteStride", std::size_t{0})};
}

document::span document::range(std::size_t buffer_index, std::uint64_t offset, std::uint64_t size,
                               const std::string &where) {
    const span data = buffer(buffer_index);
    if (offset > data.size || size > data.size - offset) {
        throw refusal(where + ": reaches beyond the " + std::to_string(data.size) +
                      " bytes of buffer " + std::to_string(buffer_index));
    }
    return {data.data + offset, static_cast<std::size_t>(size), 0};
}

std::size_t document::add_buffer(bytes data) {
    json &buffers = root["buffers"];
    buffers.push_back({{"byteLength", data.size()}});
    buffers_.emplace(buffers.size() - 1, std::move(data));
    return buffers.size() - 1;
}

} // namespace girih_gltf
