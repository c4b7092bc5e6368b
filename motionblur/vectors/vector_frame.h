// Another program's flat OpenEXR image, with forward motion vectors and possibly depth.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "motionblur/vectors/vector_channels.h"
#include "pictures/foreign/foreign_channels.h"
#include "pictures/image.h"

namespace postlens {

/// Values of one pixel in the file.
struct VectorPixel {
    std::array<float, 3> rgb{};       ///< scene-linear, and premultiplied if the file has alpha
    float inverse_z = 0;              ///< 1 / depth in the file's unit; 0 if infinitely far
    float right_px = 0, down_px = 0;  ///< displacement from this frame to the next
    std::uint32_t id = 0;             ///< id of the surface; 0 if the file has none
    [[nodiscard]] bool still() const { return right_px == 0 && down_px == 0; }
};

struct VectorFrame {
    int width = 0, height = 0;  ///< size of the display window, px, which is the raster
    /// The rectangle of pixels that the file stores: [x_begin, x_end) x [y_begin, y_end). It may extend
    /// beyond the display window, which is the visible image.
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    std::vector<VectorPixel> pixels;  ///< row-major
    bool has_z = false, has_alpha = false;
    double largest_px = 0;  ///< length of the longest vector
    std::string u_name, v_name;
    std::string id_name;  ///< channel of the ids; empty if there are no ids
    /// One message for each id channel or Cryptomatte of the file that cannot be used.
    std::vector<std::string> problems;
    std::vector<std::string> assumed;  ///< one line for each assumption about the file

    [[nodiscard]] const VectorPixel& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(x_end - x_begin) +
                      static_cast<std::size_t>(x - x_begin)];
    }
    [[nodiscard]] bool stores(int x, int y) const {
        return x >= x_begin && x < x_end && y >= y_begin && y < y_end;
    }
    /// Returns the image in the display window, black where the file stores no pixel.
    [[nodiscard]] Image picture() const;
};

/// Reads an image with motion vectors. `choice` selects the colours (pictures/foreign/foreign_channels.h).
/// Vectors, alpha, depth and ids may come from any part of the file. Of a stereo file, the hero view is used.
///
/// Depth increases with distance. A pixel is infinitely far if its depth is 0 or at least 1e9, or if its
/// alpha is 0. Without depth, pixels that move faster count as nearer.
///
/// Throws Error(invalid_input) for other kinds of files, for windows larger or farther apart than 65536 px,
/// and, with the pixel's position, for values that are not finite, vectors longer than 1e6 px and negative
/// depths. Throws Error(out_of_memory) before memory is allocated.
[[nodiscard]] VectorFrame read_vector_frame(const std::filesystem::path& path, const VectorChoice& vectors,
                                            const ForeignChoice& choice = {});

}  // namespace postlens
