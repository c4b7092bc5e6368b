#include <Imath/ImathBox.h>
#include <Imath/ImathMatrix.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIDManifest.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <nlohmann/json.hpp>
#include <utility>

#include "records/file/sample_file_header.h"
#include "records/file/sample_header_names.h"

namespace postlens {
namespace {

using namespace attribute;
using namespace layout;

Imf::IDManifest manifest_of(const SampleHeader& header) {
    Imf::IDManifest manifest;
    auto& group = manifest.add("id");
    group.setComponent("name");
    group.setLifetime(Imf::IDManifest::LIFETIME_FRAME);
    group.setHashScheme(Imf::IDManifest::NOTHASHED);
    group.setEncodingScheme(Imf::IDManifest::ID_SCHEME);
    for (const auto& [id, name] : header.object_names) group.insert(id, name);
    return manifest;
}

/// Converts a glm matrix to an OpenEXR matrix. glm stores columns of a matrix for column vectors. OpenEXR
/// stores rows of its transpose. So the order of the numbers is the same.
Imath::M44d imath_of(const glm::dmat4& m) {
    Imath::M44d out;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) out[i][j] = m[i][j];
    }
    return out;
}

/// Adds standard OpenEXR attributes, in single precision, for other programs. The reader of sample files uses
/// postlens's own attributes, in double precision.
void add_standard_attributes(Imf::Header& out, const SampleHeader& header) {
    const auto add_float = [&](const char* name, double value) {
        out.insert(name, Imf::FloatAttribute(static_cast<float>(value)));
    };
    if (header.projection == Projection::perspective) {
        add_float("nominalFocalLength", header.focal_length_mm);
        add_float("pinholeFocalLength", header.film_distance_mm);
        out.insert("sensorOverallDimensions",
                   Imf::V2fAttribute({static_cast<float>(header.width * header.pixel_pitch_mm),
                                      static_cast<float>(header.height * header.pixel_pitch_mm)}));
    }
    if (header.f_number) add_float("aperture", *header.f_number);
    if (header.focus_m) add_float("focus", *header.focus_m);
    if (header.exposure_s) add_float("expTime", *header.exposure_s);
    // The camera looks along +z in OpenEXR, but along -z in postlens.
    glm::dmat4 camera_from_world = glm::inverse(header.world_from_camera);
    for (int column = 0; column < 4; ++column) camera_from_world[column][2] *= -1;
    Imf::addWorldToCamera(out, Imath::M44f(imath_of(camera_from_world)));
}

void add_own_attributes(Imf::Header& out, const SampleHeader& h) {
    const auto add_int = [&](const char* name, int value) { out.insert(name, Imf::IntAttribute(value)); };
    const auto add_double = [&](const char* name, double value) {
        out.insert(name, Imf::DoubleAttribute(value));
    };
    const auto add_optional = [&](const char* name, const std::optional<double>& value) {
        if (value) add_double(name, *value);
    };
    const auto add_text = [&](const char* name, const std::string& value) {
        out.insert(name, Imf::StringAttribute(value));
    };
    add_int(version_name, h.version);
    add_text(projection_name, h.projection == Projection::perspective ? perspective_text : orthographic_text);
    add_double(film_distance_name, h.film_distance_mm);
    add_double(pixel_pitch_name, h.pixel_pitch_mm);
    add_double(focal_length_name, h.focal_length_mm);
    add_optional(f_number_name, h.f_number);
    add_optional(focus_name, h.focus_m);
    add_optional(exposure_name, h.exposure_s);
    out.insert(camera_name, Imf::M44dAttribute(imath_of(h.world_from_camera)));
    add_double(frame_time_name, h.time_s);
    add_int(overscan_name, h.overscan_px);
    add_int(subdivide_levels_name, h.subdivide_levels);
    add_double(subdivide_threshold_name, h.subdivide_threshold);
    add_int(max_depth_name, h.max_depth);
    add_double(min_contribution_name, h.min_contribution);
    if (h.exposure_stops != 0) add_double(exposure_stops_name, h.exposure_stops);
    add_optional(auto_exposure_stops_name, h.auto_exposure_stops);
    add_optional(lumens_per_watt_name, h.lumens_per_watt);
    add_optional(metres_per_unit_name, h.metres_per_unit);
    add_text(scene_name_name, h.scene_name);
    add_text(scene_sha256_name, h.scene_sha256);
    if (!h.made_by.empty()) add_text(made_by_name, h.made_by);
    add_text(moving_ids_name, nlohmann::json(h.moving_ids).dump());
    add_int(lights_move_name, h.lights_move ? 1 : 0);
    if (!h.motion.empty()) add_text(motion_name, motion_text(h.motion));
    add_optional(sufficient_f_number_name, h.sufficient.smallest_f_number);
    add_optional(sufficient_near_name, h.sufficient.nearest_focus_m);
    add_optional(sufficient_far_name, h.sufficient.farthest_focus_m);
    add_optional(sufficient_open_name, h.sufficient.shutter_open_s);
    add_optional(sufficient_close_name, h.sufficient.shutter_close_s);
    add_text(checksum_name, header_checksum(h));
}

}  // namespace

std::vector<Imf::Header> exr_headers_of(const SampleHeader& header, ChunkCompression records,
                                        ChunkCompression picture) {
    const auto box = [](const Window& w) { return Imath::Box2i({w.x_min, w.y_min}, {w.x_max, w.y_max}); };
    const RecordChannels channels{header.has_w, header.has_layers, header.has_bend, header.has_marks};
    std::vector<Imf::Header> headers;
    for (std::size_t i = 0; i < parts_of(header.key_times_s.size()); ++i) {
        const PartPlace place = part_at(i);
        const Part part = place.part;
        const Window window = data_window(part, header);
        const ChunkCompression compression = part == picture_part   ? picture
                                             : part == records_part ? records
                                                                    : ChunkCompression::none;
        Imf::Header out(box(display_window(header)), box(window));
        out.setName(part_name(place));
        out.setType(part_types[static_cast<std::size_t>(part)]);
        out.compression() = static_cast<Imf::Compression>(compression);
        out.setChunkCount(static_cast<int>(chunks_of(rows_of(window), compression)));
        for (const ExrChannel& c : channels_of(part, channels)) {
            out.channels().insert(c.name, Imf::Channel(static_cast<Imf::PixelType>(c.type)));
        }
        if (part == picture_part) {
            add_standard_attributes(out, header);
            add_own_attributes(out, header);
        }
        if (place.instant > 0) {
            out.insert(key_time_name, Imf::DoubleAttribute(header.key_times_s[place.instant - 1]));
        }
        if (part == records_part) out.setVersion(1);  // version of the layout of deep chunks
        if (part == records_part && place.instant == 0) {
            Imf::addComments(
                out, "postlens: the records of a pixel add up, they do not composite; do not flatten");
            if (!header.object_names.empty()) {
                Imf::addIDManifest(out, Imf::CompressedIDManifest(manifest_of(header)));
            }
        }
        headers.push_back(std::move(out));
    }
    return headers;
}

}  // namespace postlens
