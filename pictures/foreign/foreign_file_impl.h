// Implementation of ForeignFile, which reads OpenEXR files of other programs: the file as the OpenEXR library
// opens it, and functions for its flat parts (one sample per pixel) and deep parts.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPixelType.h>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "pictures/foreign/foreign_file.h"

namespace postlens {

namespace foreign {

/// Data of more than 64 MB are accepted only if the file is large enough for them (see `densest`).
inline constexpr std::uint64_t unquestioned_bytes = 64U << 20U;
/// Largest plausible compression ratio, that is, uncompressed size / compressed size. Deflate, the method
/// with the highest ratio, reaches at most 1032, and the limit has a margin. If the data of a file would need
/// a higher ratio, the file is damaged.
inline constexpr std::uint64_t densest = 4096;

/// Returns the number of rows that are compressed together.
[[nodiscard]] int chunk_rows(const Imf::Header& h);

/// Returns the type in which the OpenEXR library must read a channel: integer for integer channels, float for
/// all others. Throws Error(invalid_input) if the channel is missing or subsampled.
[[nodiscard]] Imf::PixelType read_as(const Imf::Header& h, const std::string& channel,
                                     const std::string& name);

/// Calls the OpenEXR library and converts its exceptions to Error. Passes on a failure to start a thread,
/// which is no fault of the file.
template <typename Call>
auto guarded(const std::string& name, const Call& call) {
    try {
        return call();
    } catch (const Error&) {
        throw;
    } catch (const std::system_error&) {
        throw;
    } catch (const std::bad_alloc&) {
        fail(ExitCode::out_of_memory, "{}: not enough memory to read it", name);
    } catch (const std::exception& e) {
        fail(ExitCode::invalid_input, "{}: cannot read ({})", name, reason_of(e.what()));
    }
}

}  // namespace foreign

struct ForeignFile::Impl {
    struct Opened {
        std::string name;
        std::uint64_t bytes = 0;
        std::size_t first_part = 0;
        std::unique_ptr<Imf::MultiPartInputFile> file;
    };
    std::vector<Opened> files;  ///< the image's own file, then attached files

    [[nodiscard]] const Opened& of(std::size_t part) const {
        std::size_t i = files.size() - 1;
        while (files[i].first_part > part) --i;
        return files[i];
    }
    /// Returns the index of the part within its own file.
    [[nodiscard]] int number(std::size_t part) const { return static_cast<int>(part - of(part).first_part); }
    [[nodiscard]] const Imf::Header& header(std::size_t part) const {
        return of(part).file->header(number(part));
    }
    template <typename Attribute>
    [[nodiscard]] const Attribute* find(std::size_t part, const char* name) const {
        return header(part).findTypedAttribute<Attribute>(name);
    }
};

}  // namespace postlens
