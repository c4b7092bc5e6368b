// Inside ForeignFile: the OpenEXR library's file, and what reading flat and deep pixels have in common.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPixelType.h>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "core/error.h"
#include "records/foreign_file.h"

namespace postlens {

namespace foreign {

/// What may be asked for without a look at the file's own size.
inline constexpr std::uint64_t unquestioned_bytes = 64U << 20U;
/// The densest of the formats, deflate, packs 1032 to 1; twice over in none of them.
inline constexpr std::uint64_t densest = 4096;

/// A message of the library, in one line.
[[nodiscard]] std::string one_line(std::string text);

/// Rows that are compressed together.
[[nodiscard]] int chunk_rows(const Imf::Header& h);

/// What the library reads a channel as; whole numbers keep their bits, in the place of a float. Throws
/// Error(invalid_input) for a channel that is missing or subsampled.
[[nodiscard]] Imf::PixelType read_as(const Imf::Header& h, const std::string& channel,
                                     const std::string& name);

/// Runs what calls the OpenEXR library, whose exceptions become ours.
template <typename Call>
auto guarded(const std::string& name, const Call& call) {
    try {
        return call();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        fail(ExitCode::out_of_memory, "{}: not enough memory to read it", name);
    } catch (const std::exception& e) {
        fail(ExitCode::invalid_input, "{}: cannot read ({})", name, one_line(e.what()));
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
    std::vector<Opened> files;  ///< the picture's, and those attached

    [[nodiscard]] const Opened& of(std::size_t part) const {
        std::size_t i = files.size() - 1;
        while (files[i].first_part > part) --i;
        return files[i];
    }
    /// The part's number in its own file.
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
