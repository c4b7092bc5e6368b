#include "scene/gltf/gltf_document.h"

#include <array>
#include <cstring>
#include <optional>

#include "core/files/text_file.h"
#include "core/percent.h"
#include "core/text.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view glb_magic = "glTF";
constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

// All supported machines are little-endian, so no conversion is needed.
std::uint32_t word(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

struct Parts {
    std::string_view json;
    std::optional<std::string_view> binary;
};

Parts parts_of(std::string_view all, const std::string& file) {
    if (!all.starts_with(glb_magic)) return {all, std::nullopt};
    constexpr std::size_t header = 12, chunk_header = 8;
    if (all.size() < header + chunk_header) fail(ExitCode::invalid_input, "{}: is cut short", file);
    if (const std::uint32_t version = word(all, 4); version != 2) {
        fail(ExitCode::invalid_input, "{}: is of another version (got {}; expected 2)", file, version);
    }
    const std::size_t length = word(all, 8);
    if (length > all.size() || length < header + chunk_header) {
        fail(ExitCode::invalid_input, "{}: is cut short (got {} bytes; expected {})", file, all.size(),
             length);
    }
    Parts parts;
    for (std::size_t at = header; at + chunk_header <= length;) {
        const std::size_t size = word(all, at);
        const std::uint32_t kind = word(all, at + 4);
        at += chunk_header;
        if (size > length - at) {
            fail(ExitCode::invalid_input, "{}: a chunk runs over the end (got {} bytes; expected at most {})",
                 file, size, length - at);
        }
        const std::string_view chunk = all.substr(at, size);
        if (kind == json_chunk && parts.json.empty()) parts.json = chunk;
        if (kind == binary_chunk && !parts.binary) parts.binary = chunk;
        at += size;
    }
    if (parts.json.empty()) fail(ExitCode::invalid_input, "{}: has no JSON chunk", file);
    return parts;
}

int digit_of(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;
    if (c == '/' || c == '_') return 63;
    return -1;
}

std::string from_base64(std::string_view text, const JsonPlace& place) {
    std::string out;
    out.reserve(text.size() / 4 * 3);
    std::uint32_t bits = 0;
    int held = 0;
    for (const char c : text) {
        if (c == '=') break;
        const int digit = digit_of(c);
        if (digit < 0) place.fail_here("has a data URI that is no base64 (got {})", excerpt({&c, 1}));
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        held += 6;
        if (held >= 8) {
            held -= 8;
            out.push_back(static_cast<char>(bits >> held & 0xFF));
        }
    }
    return out;
}

bool has_scheme(const std::string& uri) {
    const std::size_t colon = uri.find(':');
    return colon != std::string::npos && uri.find('/') > colon;
}

void check_head(const GltfDocument& d) {
    const JsonPlace root = d.root();
    if (!d.json.is_object())
        fail(ExitCode::invalid_input, "{}: holds no object (expected a glTF document)", d.file);
    const JsonPlace asset = root.required(root.object("asset"), "asset");
    const std::string version = asset.required(asset.text("version"), "version");
    if (!version.starts_with("2.")) {
        asset.fail_here("is of another version (got {}; expected 2.0)", excerpt(version));
    }
    // A material extension of glTF that is not supported causes only a note, because the geometry is correct
    // without it.
    constexpr std::array<std::string_view, 3> known{"KHR_lights_punctual", "KHR_texture_transform",
                                                    "KHR_mesh_quantization"};
    for (const std::string& name : root.texts("extensionsRequired")) {
        if (name.starts_with("KHR_materials_")) continue;
        if (std::find(known.begin(), known.end(), name) == known.end()) {
            fail(ExitCode::invalid_input, "{}: requires an extension that is not supported (got {})", d.file,
                 excerpt(name));
        }
    }
}

void read_buffers(GltfDocument& d, const std::optional<std::string_view>& binary) {
    std::uintmax_t total = 0;
    for (const JsonPlace& b : d.root().objects("buffers")) {
        const std::size_t length = b.required(b.whole("byteLength", 1, largest_gltf_bytes), "byteLength");
        const auto uri = b.text("uri");
        std::string_view bytes;
        if (uri) {
            bytes = d.resolve(*uri, b);
        } else if (d.buffers.empty() && binary) {
            bytes = *binary;
        } else {
            b.fail_here("has no 'uri' (expected one, or a .glb with its bytes)");
        }
        if (bytes.size() < length) {
            b.fail_here("is too short (got {} bytes; expected {})", bytes.size(), length);
        }
        total += length;
        if (total > largest_gltf_bytes) {
            b.fail_here("makes too much (expected at most {} bytes in all)", largest_gltf_bytes);
        }
        d.buffers.push_back(bytes.substr(0, length));
    }
}

// Throws an error unless every buffer view lies within its buffer.
void check_views(const GltfDocument& d) {
    for (const JsonPlace& v : d.root().objects("bufferViews")) {
        const std::size_t buffer = v.required(v.index("buffer", d.buffers.size()), "buffer");
        const std::size_t offset = v.whole("byteOffset", 0, largest_gltf_bytes).value_or(0);
        const std::size_t length = v.required(v.whole("byteLength", 1, largest_gltf_bytes), "byteLength");
        if (offset + length > d.buffers[buffer].size()) {
            v.fail_here("runs over its buffer's end (got bytes up to {}; expected at most {})",
                        offset + length, d.buffers[buffer].size());
        }
    }
}

}  // namespace

std::string_view GltfDocument::view(std::size_t index) const {
    const nlohmann::json& v = json["bufferViews"][index];
    return buffers[v["buffer"].get<std::size_t>()].substr(
        static_cast<std::size_t>(v.value("byteOffset", 0.0)),
        static_cast<std::size_t>(v["byteLength"].get<double>()));
}

std::size_t GltfDocument::count(const char* array) const {
    const auto at = json.find(array);
    return at != json.end() && at->is_array() ? at->size() : 0;
}

JsonPlace GltfDocument::item(const char* array, std::size_t index) const {
    return {file, json.at(array).at(index), fmt::format("{}[{}]", array, index)};
}

std::string_view GltfDocument::resolve(const std::string& uri, const JsonPlace& place) {
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(',');
        if (comma == std::string::npos || uri.substr(0, comma).find(";base64") == std::string::npos) {
            place.fail_here("has a data URI of an unknown kind (expected base64)");
        }
        return bytes.emplace_back(from_base64(std::string_view(uri).substr(comma + 1), place));
    }
    if (has_scheme(uri)) place.fail_here("refers to no file beside it (got {})", excerpt(uri));
    const std::string name = percent_decoded(uri);
    const auto found = inside_scene_folder(path, name);
    if (!found) {
        place.fail_here("leads out of the scene's folder (got {}; expected a path inside it)", excerpt(uri));
    }
    try {
        bytes.push_back(read_text_file(*found, largest_gltf_bytes));
    } catch (const Error& error) {
        if (error.code() != ExitCode::invalid_input) throw;
        place.fail_here("refers to a file that cannot be read ({})", error.what());
    }
    files.push_back({uri, *found});
    return bytes.back();
}

void read_gltf_document(const fs::path& path, GltfDocument& out) {
    out.path = path;
    out.file = path.string();
    out.bytes.push_back(read_text_file(path, largest_gltf_bytes));
    const Parts parts = parts_of(out.bytes.front(), out.file);
    out.json = parse_json(parts.json, out.file);
    check_head(out);
    read_buffers(out, parts.binary);
    check_views(out);
}

}  // namespace postlens
