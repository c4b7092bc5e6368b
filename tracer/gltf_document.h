// A glTF 2.0 document [gltf2] and the bytes that belong to it: .gltf with files or data URIs, or .glb.
#pragma once

#include <deque>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tracer/json_place.h"
#include "tracer/referred_files.h"

namespace postlens {

struct GltfDocument {
    std::filesystem::path path;
    std::string file;  ///< the path, as errors name it
    nlohmann::json json;
    std::deque<std::string> bytes;          ///< the file itself first, then what it refers to
    std::vector<std::string_view> buffers;  ///< each as long as it says
    std::vector<ReferredFile> files;        ///< for the scene's SHA-256

    GltfDocument() = default;
    ~GltfDocument() = default;
    GltfDocument(const GltfDocument&) = delete;  // the views point into `bytes`
    GltfDocument& operator=(const GltfDocument&) = delete;
    GltfDocument(GltfDocument&&) = delete;
    GltfDocument& operator=(GltfDocument&&) = delete;

    [[nodiscard]] JsonPlace root() const { return {file, json, ""}; }
    /// The bytes of a buffer view; `index` is in range.
    [[nodiscard]] std::string_view view(std::size_t index) const;
    /// How many things an array of the document has; 0 where it has no such array.
    [[nodiscard]] std::size_t count(const char* array) const;
    /// Number `index` of such an array; it exists.
    [[nodiscard]] JsonPlace item(const char* array, std::size_t index) const;

    /// What a URI stands for: the bytes of a data URI, or of a file in the scene's folder or below, which is
    /// then one of `files`. `place` is who refers to it. Throws Error(invalid_input) for every other URI, a
    /// file that leads out of the folder or cannot be read.
    [[nodiscard]] std::string_view resolve(const std::string& uri, const JsonPlace& place);
};

/// Largest file, or sum of what it refers to, that is read, bytes.
inline constexpr std::uintmax_t largest_gltf_bytes = std::uintmax_t{1} << 31;

/// Reads `path` into the empty `out`: by its first bytes a .glb, else JSON. Every buffer is there and as long
/// as it says. Throws Error(invalid_input) "FILE: PLACE ...", also for a version other than 2 and for a
/// required extension that is not known.
void read_gltf_document(const std::filesystem::path& path, GltfDocument& out);

}  // namespace postlens
