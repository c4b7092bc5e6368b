// A glTF 2.0 document [gltf2] with its binary data, from a .glb, or from a .gltf and the files it names.
#pragma once

#include <deque>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/json_place.h"
#include "scene/referred_files.h"

namespace postlens {

struct GltfDocument {
    std::filesystem::path path;
    std::string file;  ///< the path, for error messages
    nlohmann::json json;
    std::deque<std::string> bytes;  ///< the file, followed by the files and data URIs to which it refers
    std::vector<std::string_view> buffers;  ///< each has the length that the document states
    std::vector<ReferredFile> files;        ///< for the scene's SHA-256

    GltfDocument() = default;
    ~GltfDocument() = default;
    GltfDocument(const GltfDocument&) = delete;  // the views point into `bytes`
    GltfDocument& operator=(const GltfDocument&) = delete;
    GltfDocument(GltfDocument&&) = delete;
    GltfDocument& operator=(GltfDocument&&) = delete;

    [[nodiscard]] JsonPlace root() const { return {file, json, ""}; }
    /// Returns the bytes of a buffer view, which is a range of bytes in a buffer of the glTF file. `index` is
    /// its number in the file, and must be in range.
    [[nodiscard]] std::string_view view(std::size_t index) const;
    /// Returns the number of elements in an array of the document, or 0 if there is no such array.
    [[nodiscard]] std::size_t count(const char* array) const;
    /// Returns element `index` of an array of the document. The element must exist.
    [[nodiscard]] JsonPlace item(const char* array, std::size_t index) const;

    /// Returns the bytes to which `uri` refers: those that a data URI contains, or those of a file, which is
    /// added to `files`. Error messages name `place`, the JSON object that contains the URI.
    /// Throws Error(invalid_input):
    /// - for other kinds of URI
    /// - for a file that cannot be read
    /// - for a path out of the scene's folder
    [[nodiscard]] std::string_view resolve(const std::string& uri, const JsonPlace& place);
};

/// Largest accepted size, in bytes, of a file, and of all buffers of a document together.
inline constexpr std::uintmax_t largest_gltf_bytes = std::uintmax_t{1} << 31;

/// Reads `path` into `out`, which must be empty. The first bytes of the file tell .glb from JSON.
/// Throws Error(invalid_input) "FILE: PLACE ..." for:
/// - an invalid file, or a version other than 2
/// - a buffer that is missing or shorter than stated
/// - a required extension that is not supported
void read_gltf_document(const std::filesystem::path& path, GltfDocument& out);

}  // namespace postlens
