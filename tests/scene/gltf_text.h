// Writes small glTF documents, as text or binary.
#pragma once

#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <string>
#include <string_view>
#include <vector>

namespace postlens::test {

/// Encodes bytes in base64, with padding.
inline std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            out.push_back(i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63]);
        }
    }
    return out;
}

/// A document with mesh 0, the triangle (0,0,0), (1,0,0), (0,1,0), and node 0, which shows this mesh. Tests
/// add accessors and animations, and replace the public members.
class GltfText {
  public:
    GltfText() {
        positions_ = floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
        mesh = fmt::format(R"({{"primitives":[{{"attributes":{{"POSITION":{}}}}}]}})", positions_);
    }

    /// Adds an accessor of floats. Returns its index.
    int floats(const std::vector<float>& values, const std::string& type) {
        const std::size_t per = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : 4;
        return accessor({reinterpret_cast<const char*>(values.data()), 4 * values.size()}, 5126,
                        values.size() / per, type);
    }
    /// Adds an accessor of raw bytes, with further JSON members. Returns its index.
    int accessor(std::string_view raw, int component, std::size_t count, const std::string& type,
                 const std::string& members = "") {
        const int view = bytes(raw);
        accessors_ += fmt::format(R"({}{{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})",
                                  accessors_.empty() ? "" : ",", view, component, count, type, members);
        return count_++;
    }
    /// Adds a buffer view. Returns its index.
    int bytes(std::string_view raw) {
        while (buffer_.size() % 4 != 0) buffer_.push_back('\0');
        views_ += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}}})",
                              views_.empty() ? "" : ",", buffer_.size(), raw.size());
        buffer_ += raw;
        return view_count_++;
    }
    /// Adds an animation of one channel, `path` of a node.
    void animate(int node, const std::string& path, const std::string& interpolation,
                 const std::vector<float>& times, const std::vector<float>& values) {
        const int input = floats(times, "SCALAR"),
                  output = floats(values, path == "rotation" ? "VEC4" : "VEC3");
        animations_ += fmt::format(
            R"({}{{"channels":[{{"sampler":0,"target":{{"node":{},"path":"{}"}}}}],"samplers":[{{"input":{},"output":{},"interpolation":"{}"}}]}})",
            animations_.empty() ? "" : ",", node, path, input, output, interpolation);
    }

    /// The document as .gltf, with its buffer in base64.
    [[nodiscard]] std::string text() const {
        return document(fmt::format(R"("uri":"data:application/octet-stream;base64,{}",)", base64(buffer_)));
    }
    /// The document as .gltf, with its buffer in the file `uri`.
    [[nodiscard]] std::string text_with_file(const std::string& uri) const {
        return document(fmt::format(R"("uri":"{}",)", uri));
    }
    [[nodiscard]] const std::string& buffer() const { return buffer_; }
    /// The document as .glb.
    [[nodiscard]] std::string binary() const {
        std::string json = document(""), bin = buffer_;
        while (json.size() % 4 != 0) json.push_back(' ');
        while (bin.size() % 4 != 0) bin.push_back('\0');
        std::string out = "glTF";
        add_word(out, 2);
        add_word(out, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + bin.size()));
        add_word(out, static_cast<std::uint32_t>(json.size()));
        out += "JSON" + json;
        add_word(out, static_cast<std::uint32_t>(bin.size()));
        out += std::string("BIN\0", 4) + bin;
        return out;
    }

    std::string nodes = R"({"mesh":0})";  ///< all nodes, separated by commas
    std::string roots = "0";              ///< indices of the root nodes, separated by commas
    std::string mesh;                     ///< all meshes, separated by commas
    std::string more;                     ///< further members of the document, each followed by a comma

  private:
    static void add_word(std::string& out, std::uint32_t word) {
        char raw[4];
        std::memcpy(raw, &word, 4);
        out.append(raw, 4);
    }
    [[nodiscard]] std::string document(const std::string& uri) const {
        return fmt::format(
            R"({{"asset":{{"version":"2.0"}},{}"scenes":[{{"nodes":[{}]}}],"nodes":[{}],"meshes":[{}],)"
            R"("animations":[{}],"accessors":[{}],"bufferViews":[{}],"buffers":[{{{}"byteLength":{}}}]}})",
            more, roots, nodes, mesh, animations_, accessors_, views_, uri, buffer_.size());
    }

    std::string buffer_, accessors_, views_, animations_;
    int count_ = 0, view_count_ = 0, positions_ = 0;
};

}  // namespace postlens::test
