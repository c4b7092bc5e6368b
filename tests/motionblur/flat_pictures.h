// Flat images with motion vectors, and a fixture that reads them.
#pragma once

#include <OpenImageIO/imageio.h>
#include <functional>
#include <string>
#include <vector>

#include "motionblur/vectors/vector_frame.h"
#include "tests/support/command_test.h"

namespace postlens::test {

/// A data window or display window, px.
struct Window {
    int x = 0, y = 0, width = 64, height = 48;
};

/// Writes a flat OpenEXR image; `values` returns the channels of a pixel by its position in the file.
struct FlatPicture {
    std::vector<std::string> channels{"R", "G", "B", "Z", "forward.u", "forward.v"};
    Window data, display;
    std::function<std::vector<float>(int x, int y)> values;

    void write(const std::string& path) const {
        OIIO::ImageSpec spec(data.width, data.height, static_cast<int>(channels.size()),
                             OIIO::TypeDesc::FLOAT);
        spec.x = data.x;
        spec.y = data.y;
        spec.full_x = display.x;
        spec.full_y = display.y;
        spec.full_width = display.width;
        spec.full_height = display.height;
        spec.channelnames = channels;
        std::vector<float> all;
        for (int y = data.y; y < data.y + data.height; ++y) {
            for (int x = data.x; x < data.x + data.width; ++x) {
                const std::vector<float> v = values(x, y);
                all.insert(all.end(), v.begin(), v.end());
            }
        }
        const auto out = OIIO::ImageOutput::create(path);
        ASSERT_TRUE(out && out->open(path, spec) && out->write_image(OIIO::TypeDesc::FLOAT, all.data()) &&
                    out->close())
            << OIIO::geterror();
    }
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
