#include "scene/mesh/mesh_files.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "core/files/text_file.h"

namespace postlens {
namespace {

class MemoryStream : public Assimp::IOStream {
  public:
    explicit MemoryStream(std::string bytes) : bytes_(std::move(bytes)) {}

    std::size_t Read(void* to, std::size_t size, std::size_t count) override {
        if (size == 0) return 0;
        const std::size_t items = std::min(count, (bytes_.size() - at_) / size);
        std::memcpy(to, bytes_.data() + at_, items * size);
        at_ += items * size;
        return items;
    }
    std::size_t Write(const void* /*from*/, std::size_t /*size*/, std::size_t /*count*/) override {
        return 0;
    }
    aiReturn Seek(std::size_t offset, aiOrigin origin) override {
        const std::size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
        // For aiOrigin_END, assimp counts the offset backwards from the end of the file.
        const std::size_t to = origin == aiOrigin_END ? base - std::min(base, offset) : base + offset;
        if (to > bytes_.size()) return aiReturn_FAILURE;
        at_ = to;
        return aiReturn_SUCCESS;
    }
    [[nodiscard]] std::size_t Tell() const override { return at_; }
    [[nodiscard]] std::size_t FileSize() const override { return bytes_.size(); }
    void Flush() override {}

  private:
    std::string bytes_;
    std::size_t at_ = 0;
};

void append_utf8(std::string& out, std::uint32_t c) {
    if (c < 0x80) {
        out.push_back(static_cast<char>(c));
    } else if (c < 0x800) {
        out.push_back(static_cast<char>(0xC0 | c >> 6));
        out.push_back(static_cast<char>(0x80 | (c & 0x3F)));
    } else {
        out.push_back(static_cast<char>(0xE0 | c >> 12));
        out.push_back(static_cast<char>(0x80 | (c >> 6 & 0x3F)));
        out.push_back(static_cast<char>(0x80 | (c & 0x3F)));
    }
}

}  // namespace

std::string as_utf8(std::string text) {
    if (text.starts_with("\xEF\xBB\xBF")) return text.substr(3);
    const bool big = text.starts_with("\xFE\xFF"), little = text.starts_with("\xFF\xFE");
    if (!big && !little) return text;
    std::string out;
    out.reserve(text.size() / 2);
    for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
        const auto high = static_cast<unsigned char>(text[big ? i : i + 1]);
        const auto low = static_cast<unsigned char>(text[big ? i + 1 : i]);
        const std::uint32_t c = static_cast<std::uint32_t>(high) << 8 | low;
        // UTF-16 surrogates encode rare characters, which occur only in names, where '?' does no harm.
        if (c >= 0xD800 && c < 0xE000) {
            out.push_back('?');
        } else {
            append_utf8(out, c);
        }
    }
    return out;
}

std::string MeshFiles::as_written(const std::string& file) const {
    const std::string folder = scene_path_.parent_path().string();
    std::string name = file;
    if (!folder.empty() && name.starts_with(folder)) name.erase(0, folder.size());
    while (!name.empty() && name.front() == '/' && !folder.empty()) name.erase(0, 1);
    return name;
}

bool MeshFiles::Exists(const char* file) const {
    if (std::filesystem::path(file) == scene_path_) return true;
    const auto path = inside_scene_folder(scene_path_, as_written(file));
    std::error_code error;
    return path && std::filesystem::is_regular_file(*path, error);
}

Assimp::IOStream* MeshFiles::Open(const char* file, const char* mode) {
    if (std::strchr(mode, 'w') || std::strchr(mode, 'a')) return nullptr;
    if (std::filesystem::path(file) == scene_path_) return new MemoryStream(text_);
    const std::string name = as_written(file);
    const auto path = inside_scene_folder(scene_path_, name);
    if (!path) {
        outside_.push_back(name);
        return nullptr;
    }
    try {
        const std::string bytes = as_utf8(read_text_file(*path, largest_mesh_file_bytes));
        std::string text = rewritten_mtl(bytes, pictures_, notes_);
        opened_.push_back({name, *path});
        return new MemoryStream(std::move(text));
    } catch (const Error&) {
        missing_.push_back(name);
        return nullptr;
    }
}

void MeshFiles::Close(Assimp::IOStream* stream) {
    delete stream;
}

}  // namespace postlens
