// Flat OpenEXR images as other programs write them. They are written with OpenEXR itself: a program that is
// linked with OpenImageIO takes 0.2 s to start, and every test starts its program.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <functional>
#include <string>
#include <vector>

namespace postlens::test {

/// A data window or display window, px.
struct Window {
    int x = 0, y = 0, width = 64, height = 48;

    [[nodiscard]] Imath::Box2i box() const { return {{x, y}, {x + width - 1, y + height - 1}}; }
};

/// The values of the channels at a pixel.
using PixelValues = std::function<std::vector<float>(int x, int y)>;

/// Writes an image of float channels. `values` is called for every pixel of the data window.
inline void write_flat_exr(const std::string& path, const std::vector<std::string>& channels,
                           const Window& data, const Window& display, const PixelValues& values) {
    std::vector<float> all;
    for (int y = data.y; y < data.y + data.height; ++y) {
        for (int x = data.x; x < data.x + data.width; ++x) {
            const std::vector<float> v = values(x, y);
            all.insert(all.end(), v.begin(), v.end());
        }
    }
    Imf::Header header(display.box(), data.box());
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        header.channels().insert(channels[c], Imf::Channel(Imf::FLOAT));
        frame.insert(channels[c], Imf::Slice::Make(Imf::FLOAT, all.data() + c, data.box(),
                                                   channels.size() * sizeof(float)));
    }
    Imf::OutputFile out(path.c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(data.height);
}

/// The same, with a display window that is the data window, from (0, 0).
inline void write_flat_exr(const std::string& path, const std::vector<std::string>& channels, int width,
                           int height, const PixelValues& values) {
    const Window window{0, 0, width, height};
    write_flat_exr(path, channels, window, window, values);
}

}  // namespace postlens::test
