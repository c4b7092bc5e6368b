// A flat OpenEXR picture of another program with depth and forward motion vectors.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "motionblur/vector_channels.h"
#include "records/foreign_channels.h"
#include "records/image.h"

namespace postlens {

/// What the file says of one pixel.
struct VectorPixel {
    std::array<float, 3> rgb{};       ///< scene-linear; premultiplied where the file has an alpha
    float inverse_z = 0;              ///< one over the file's unit of depth; 0: infinitely far
    float right_px = 0, down_px = 0;  ///< from this frame to the next
    std::uint32_t id = 0;             ///< of the surface; 0: the file does not say
    [[nodiscard]] bool still() const { return right_px == 0 && down_px == 0; }
};

struct VectorFrame {
    int width = 0, height = 0;  ///< of the display window, px: the raster
    /// Pixels stored: [x_begin, x_end) by [y_begin, y_end), on the raster, which they may leave on any side.
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    std::vector<VectorPixel> pixels;  ///< row-major
    bool has_z = false, has_alpha = false;
    double largest_px = 0;  ///< the longest vector
    std::string u_name, v_name;
    std::string id_name;                ///< empty: no ids
    std::vector<std::string> problems;  ///< about ids: a line for each that are there and are not used
    std::vector<std::string> assumed;   ///< a line for each thing that is surmised

    [[nodiscard]] const VectorPixel& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(x_end - x_begin) +
                      static_cast<std::size_t>(x - x_begin)];
    }
    [[nodiscard]] bool stores(int x, int y) const {
        return x >= x_begin && x < x_end && y >= y_begin && y < y_end;
    }
    /// What the display window shows; black where the file stores nothing.
    [[nodiscard]] Image picture() const;
};

/// Reads the part that has the colours (records/foreign_channels.h, `choice` as there; of a stereo file's
/// views the hero), and vectors, alpha, depth and ids wherever they are. Depth grows with the distance;
/// pixels of depth 0 or of at least 1e9 and, where there is an alpha, those of alpha 0 are the background,
/// infinitely far. Without a depth, what moves faster on the raster is taken to be nearer. Ids are those of a
/// Cryptomatte's first rank or of an id channel. Throws Error(invalid_input) for what is no such file, for
/// windows out of bounds (65536 px an edge, 65536 px between the windows), for colours and vectors that are
/// not finite or longer than 1e6 px and for negative depths, with their place; Error(out_of_memory) before
/// memory is taken.
[[nodiscard]] VectorFrame read_vector_frame(const std::filesystem::path& path, const VectorChoice& vectors,
                                            const ForeignChoice& choice = {});

}  // namespace postlens
