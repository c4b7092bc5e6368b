#include "records/flat_exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <thread>

#include "core/error.h"

namespace postlens {
namespace {

/// Remembers what went wrong: an OpenEXR file writes its table of offsets where it is destroyed, and says
/// nothing of errors there.
class FileStream : public Imf::OStream {
  public:
    explicit FileStream(const std::filesystem::path& path)
        : Imf::OStream(path.c_str()), file_(std::fopen(path.c_str(), "wbe")) {
        if (!file_) error_ = errno;
    }

    void write(const char c[], int n) override {
        const auto count = static_cast<std::size_t>(n);
        if (error_ == 0 && std::fwrite(c, 1, count, file_.get()) != count) error_ = errno;
        position_ += count;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override {
        if (error_ == 0 && ::fseeko(file_.get(), static_cast<off_t>(position), SEEK_SET) != 0) error_ = errno;
        position_ = position;
    }

    /// Closes the file; 0, or the first error's number.
    [[nodiscard]] int close() {
        // Some file systems report a full disk only here.
        if (file_ && std::fclose(file_.release()) != 0 && error_ == 0) error_ = errno;
        return error_;
    }

  private:
    struct Close {
        void operator()(std::FILE* file) const { (void)std::fclose(file); }
    };
    std::unique_ptr<std::FILE, Close> file_;
    std::uint64_t position_ = 0;
    int error_ = 0;
};

Imath::Box2i box(const Window& w) {
    return {Imath::V2i(w.x_min, w.y_min), Imath::V2i(w.x_max, w.y_max)};
}

Imf::PixelType pixel_type(ExrChannel::Type type) {
    switch (type) {
        case ExrChannel::Type::uint32:
            return Imf::UINT;
        case ExrChannel::Type::half:
            return Imf::HALF;
        default:
            return Imf::FLOAT;
    }
}

Imf::Compression compression(ChunkCompression c) {
    return static_cast<Imf::Compression>(c);  // the numbers are those of the file
}

}  // namespace

void use_exr_threads() {
    static std::once_flag once;
    std::call_once(once,
                   [] { Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency())); });
}

void write_flat_exr(const std::filesystem::path& path, const std::string& shown_name,
                    const FlatExr& picture) {
    use_exr_threads();
    FileStream stream(path);
    try {
        Imf::Header header(box(picture.display), box(picture.data));
        header.compression() = compression(picture.compression);
        for (const auto& [name, text] : picture.texts)
            header.insert(name.c_str(), Imf::StringAttribute(text));
        Imf::FrameBuffer buffer;
        // The library finds a pixel by its place in the file.
        const auto shift =
            static_cast<std::ptrdiff_t>(picture.data.x_min) *
                static_cast<std::ptrdiff_t>(picture.pixel_bytes) +
            static_cast<std::ptrdiff_t>(picture.data.y_min) * static_cast<std::ptrdiff_t>(picture.row_bytes);
        for (const FlatExr::Channel& c : picture.channels) {
            header.channels().insert(c.name, Imf::Channel(pixel_type(c.type)));
            // Only read through.
            char* first = const_cast<char*>(static_cast<const char*>(c.first));
            if (c.one_row) {
                const std::size_t bytes = c.type == ExrChannel::Type::half ? 2 : 4;
                buffer.insert(c.name, Imf::Slice(pixel_type(c.type),
                                                 first - static_cast<std::ptrdiff_t>(picture.data.x_min) *
                                                             static_cast<std::ptrdiff_t>(bytes),
                                                 bytes, 0));
                continue;
            }
            buffer.insert(c.name, Imf::Slice(pixel_type(c.type), first - shift, picture.pixel_bytes,
                                             picture.row_bytes));
        }
        Imf::OutputFile file(stream, header);
        file.setFrameBuffer(buffer);
        file.writePixels(picture.data.y_max - picture.data.y_min + 1);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        fail(ExitCode::cannot_write, "{}: cannot write ({})", shown_name, e.what());
    }
    if (const int error = stream.close(); error != 0)
        fail(ExitCode::cannot_write, "{}: cannot write ({})", shown_name, std::strerror(error));
}

}  // namespace postlens
