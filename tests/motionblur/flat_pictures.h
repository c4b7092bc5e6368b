// Flat images with motion vectors, and a fixture that reads them.
#pragma once

#include <string>
#include <vector>

#include "motionblur/vectors/vector_frame.h"
#include "tests/support/command_test.h"
#include "tests/support/flat_exr.h"

namespace postlens::test {

/// Writes a flat OpenEXR image; `values` returns the channels of a pixel by its position in the file.
struct FlatPicture {
    std::vector<std::string> channels{"R", "G", "B", "Z", "forward.u", "forward.v"};
    Window data, display;
    PixelValues values;

    void write(const std::string& path) const { write_flat_exr(path, channels, data, display, values); }
};

/// The rectangle of the plate, px, and the red values of plate and ground.
inline constexpr int plate_x = 12, plate_y = 14, plate_width = 30, plate_height = 20;
inline constexpr float plate_colour = 0.75F, ground_colour = 0.25F;

inline bool in_plate(int x, int y) {
    return x >= plate_x && x < plate_x + plate_width && y >= plate_y && y < plate_y + plate_height;
}

/// A plate at a depth of 2 m, which moves by (12, 5) px, in front of a ground at 5 m. The v channel points
/// upwards.
inline FlatPicture plate() {
    FlatPicture p;
    p.values = [](int x, int y) {
        return in_plate(x, y) ? std::vector<float>{plate_colour, 0.5F, 0, 2, 12, -5}
                              : std::vector<float>{ground_colour, 0.5F, 1, 5, 0, 0};
    };
    return p;
}

/// Writes flat images to a folder of its own and reads them with their motion vectors.
class VectorFrameTest : public CommandTest {
  protected:
    VectorFrame frame_of(const FlatPicture& picture, const VectorChoice& vectors = {},
                         const ForeignChoice& choice = {}) {
        const std::string path = in("flat.exr");
        picture.write(path);
        return read_vector_frame(path, vectors, choice);
    }
    // The error message for an image; empty if there is none.
    std::string refusal(const FlatPicture& picture, ExitCode code = ExitCode::invalid_input) {
        try {
            (void)frame_of(picture);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), code) << e.what();
            return e.what();
        }
        return "";
    }
};

}  // namespace postlens::test
