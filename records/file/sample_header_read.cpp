#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIDManifest.h>
#include <algorithm>
#include <cstring>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "records/file/sample_file_header.h"
#include "records/file/sample_header_names.h"

namespace postlens {
namespace {

using namespace attribute;
using namespace layout;

constexpr std::size_t largest_manifest_bytes = 64U << 20U;

std::map<std::uint32_t, std::string> names_of_manifest(const ExrPart& part, const std::string& file) {
    std::map<std::uint32_t, std::string> names;
    const auto bytes = part.raw("idManifest", "idmanifest");
    if (!bytes) return names;
    // The attribute idManifest consists of the uncompressed size (uint64) and a zlib stream. It is
    // decompressed here, because the OpenEXR library does not check the size.
    std::uint64_t size = largest_manifest_bytes + 1;
    if (bytes->size() >= sizeof size) std::memcpy(&size, bytes->data(), sizeof size);
    if (size > largest_manifest_bytes) {
        fail(ExitCode::invalid_input, "{}: idManifest is damaged", file);
    }
    Bytes expanded(size);
    if (!inflate_zlib(bytes->subspan(sizeof size), expanded)) {
        fail(ExitCode::invalid_input, "{}: idManifest is damaged", file);
    }
    try {
        const char* begin = reinterpret_cast<const char*>(expanded.data());
        const Imf::IDManifest manifest(begin, begin + expanded.size());
        const std::size_t group = manifest.find("id");
        if (group == manifest.size()) return names;
        for (auto it = manifest[group].begin(); it != manifest[group].end(); ++it) {
            if (it.id() <= 0xFFFFFFFFU && it.text().size() == 1) {
                names.emplace(static_cast<std::uint32_t>(it.id()), it.text().front());
            }
        }
    } catch (const std::exception&) {
        fail(ExitCode::invalid_input, "{}: idManifest is damaged", file);
    }
    return names;
}

std::vector<std::uint32_t> ids_of_text(const std::string& text, const std::string& file) {
    std::vector<std::uint32_t> ids;
    const auto array = nlohmann::json::parse(text, nullptr, false);
    const bool ok = array.is_array() && std::all_of(array.begin(), array.end(), [](const auto& id) {
                        return id.is_number_unsigned() && id.template get<std::uint64_t>() <= 0xFFFFFFFFU;
                    });
    if (!ok) {
        fail(ExitCode::invalid_input, "{}: attribute {} is damaged (expected a list of ids)", file,
             moving_ids_name);
    }
    for (const auto& id : array) ids.push_back(id.get<std::uint32_t>());
    return ids;
}

/// Checks that the file has exactly the parts and channels that the header describes.
void check_parts(const ExrHeaders& headers, const SampleHeader& header, const std::string& file) {
    const RecordChannels channels{header.has_w, header.has_layers, header.has_bend, header.has_marks};
    for (std::size_t i = 0; i < headers.parts.size(); ++i) {
        const ExrPart& part = headers.parts[i];
        const PartPlace place = part_at(i);
        const Part which = place.part;
        const auto refuse = [&](const char* what) {
            fail(ExitCode::invalid_input, "{}: part {} has an unexpected {}", file, i, what);
        };
        if (part.get_string("name") != part_name(place)) refuse("name");
        if (part.get_string("type") != part_types[static_cast<std::size_t>(which)]) refuse("type");
        if (place.instant > 0 && part.get_double(key_time_name) != header.key_times_s[place.instant - 1])
            refuse("instant");
        if (part.channels() != channels_of(which, channels)) refuse("list of channels");
        if (part.get_window("displayWindow") != display_window(header)) refuse("display window");
        const Window window = data_window(which, header);
        if (part.get_window("dataWindow") != window) refuse("data window");
        const auto compression = part.compression();
        if (!compression || (which == records_part && *compression == ChunkCompression::zip))
            refuse("compression");
        if (place.instant > 0 && compression != headers.parts[which].compression()) refuse("compression");
        const auto chunks = part.get_int("chunkCount");
        if (!chunks || *chunks != static_cast<int>(chunks_of(rows_of(window), *compression)))
            refuse("chunkCount");
    }
}

}  // namespace

SampleHeader sample_header_of(const ExrHeaders& headers, const std::string& file) {
    const ExrPart& part = headers.parts.front();
    SampleHeader h;
    const auto need = [&](const auto& value, const char* name) {
        if (!value) fail(ExitCode::invalid_input, "{}: attribute {} is missing", file, name);
        return *value;
    };
    const auto need_int = [&](const char* name) { return need(part.get_int(name), name); };
    const auto need_double = [&](const char* name) { return need(part.get_double(name), name); };
    const auto need_text = [&](const char* name) { return need(part.get_string(name), name); };

    const auto version = part.get_int(version_name);
    if (!version) {
        fail(ExitCode::invalid_input, "{}: not a postlens sample file (no attribute {})", file, version_name);
    }
    h.version = *version;
    if (h.version != SampleHeader::current_version) {
        fail(ExitCode::invalid_input, "{}: sample file of another version (got {}; expected {})", file,
             h.version, SampleHeader::current_version);
    }
    if (headers.parts.size() < parts_of(0) || headers.parts.size() > parts_of(SampleHeader::most_keys) ||
        headers.parts.size() % 2 == 0) {
        fail(ExitCode::invalid_input, "{}: unexpected number of parts (got {}; expected 3, and 2 for a key)",
             file, headers.parts.size());
    }
    // Width, height and overscan are checked before all other fields, because the sizes of the file's tables
    // follow from them.
    const Window display = need(part.get_window("displayWindow"), "displayWindow");
    const auto extent = [](int low, int high) {
        return low == 0 && high >= 0 && high < largest_extent_px ? high + 1 : -1;
    };
    h.width = extent(display.x_min, display.x_max);
    h.height = extent(display.y_min, display.y_max);
    h.overscan_px = need_int(overscan_name);

    const std::string projection = need_text(projection_name);
    if (projection != perspective_text && projection != orthographic_text) {
        fail(ExitCode::invalid_input, "{}: attribute {} is damaged (expected perspective or orthographic)",
             file, projection_name);
    }
    h.projection = projection == perspective_text ? Projection::perspective : Projection::orthographic;
    h.film_distance_mm = need_double(film_distance_name);
    h.pixel_pitch_mm = need_double(pixel_pitch_name);
    h.focal_length_mm = need_double(focal_length_name);
    h.f_number = part.get_double(f_number_name);
    h.focus_m = part.get_double(focus_name);
    h.exposure_s = part.get_double(exposure_name);
    const Matrix44 camera = need(part.get_matrix(camera_name), camera_name);
    for (std::size_t i = 0; i < 16; ++i) {
        h.world_from_camera[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = camera[i];
    }
    h.time_s = need_double(frame_time_name);
    for (std::size_t i = parts_of(0); i < headers.parts.size(); i += 2) {
        h.key_times_s.push_back(need(headers.parts[i].get_double(key_time_name), key_time_name));
    }
    h.subdivide_levels = need_int(subdivide_levels_name);
    h.subdivide_threshold = need_double(subdivide_threshold_name);
    h.max_depth = need_int(max_depth_name);
    h.min_contribution = need_double(min_contribution_name);
    h.exposure_stops = part.get_double(exposure_stops_name).value_or(0);
    h.auto_exposure_stops = part.get_double(auto_exposure_stops_name);
    h.lumens_per_watt = part.get_double(lumens_per_watt_name);
    h.metres_per_unit = part.get_double(metres_per_unit_name);
    h.scene_name = need_text(scene_name_name);
    h.scene_sha256 = need_text(scene_sha256_name);
    h.made_by = part.get_string(made_by_name).value_or("");
    h.moving_ids = ids_of_text(need_text(moving_ids_name), file);
    h.lights_move = need_int(lights_move_name) != 0;
    h.motion = motion_of_text(part.get_string(motion_name).value_or(""), file);
    h.sufficient.smallest_f_number = part.get_double(sufficient_f_number_name);
    h.sufficient.nearest_focus_m = part.get_double(sufficient_near_name);
    h.sufficient.farthest_focus_m = part.get_double(sufficient_far_name);
    h.sufficient.shutter_open_s = part.get_double(sufficient_open_name);
    h.sufficient.shutter_close_s = part.get_double(sufficient_close_name);

    const ExrPart& records = headers.parts[records_part];
    h.object_names = names_of_manifest(records, file);
    for (const ExrChannel& c : need(records.channels(), "channels")) {
        h.has_w = h.has_w || c.name == "W.xx";
        h.has_layers = h.has_layers || c.name == "layer";
        h.has_bend = h.has_bend || c.name == "W.bend";
        h.has_marks = h.has_marks || c.name == "mark";
    }
    check_sample_header(h, file);
    check_parts(headers, h, file);
    if (need_text(checksum_name) != header_checksum(h)) {
        fail(ExitCode::invalid_input, "{}: header is damaged (its checksum does not match)", file);
    }
    return h;
}

}  // namespace postlens
