// Names of the attributes in the header of a sample file. docs/sample_file.md explains each attribute.
#pragma once

namespace postlens::attribute {

inline constexpr const char* version_name = "postlens.formatVersion";
inline constexpr const char* projection_name = "postlens.projection";
inline constexpr const char* film_distance_name = "postlens.filmDistance_mm";
inline constexpr const char* pixel_pitch_name = "postlens.pixelPitch_mm";
inline constexpr const char* focal_length_name = "postlens.focalLength_mm";
inline constexpr const char* f_number_name = "postlens.fNumber";
inline constexpr const char* focus_name = "postlens.focus_m";
inline constexpr const char* exposure_name = "postlens.exposure_s";
inline constexpr const char* camera_name = "postlens.worldFromCamera";
inline constexpr const char* frame_time_name = "postlens.frameTime_s";
inline constexpr const char* overscan_name = "postlens.overscan_px";
inline constexpr const char* subdivide_levels_name = "postlens.subdivideLevels";
inline constexpr const char* subdivide_threshold_name = "postlens.subdivideThreshold";
inline constexpr const char* max_depth_name = "postlens.maxDepth";
inline constexpr const char* min_contribution_name = "postlens.minContribution";
inline constexpr const char* scene_name_name = "postlens.sceneName";
inline constexpr const char* made_by_name = "postlens.made_by";
inline constexpr const char* scene_sha256_name = "postlens.sceneSha256";
inline constexpr const char* moving_ids_name = "postlens.movingIds";
inline constexpr const char* lights_move_name = "postlens.lightsMove";
inline constexpr const char* motion_name = "postlens.motion";
inline constexpr const char* sufficient_f_number_name = "postlens.sufficient.fNumber";
inline constexpr const char* sufficient_near_name = "postlens.sufficient.near_m";
inline constexpr const char* sufficient_far_name = "postlens.sufficient.far_m";
inline constexpr const char* sufficient_open_name = "postlens.sufficient.shutterOpen_s";
inline constexpr const char* sufficient_close_name = "postlens.sufficient.shutterClose_s";
inline constexpr const char* exposure_stops_name = "postlens.exposure_stops";
inline constexpr const char* auto_exposure_stops_name = "postlens.auto_exposure_stops";
inline constexpr const char* lumens_per_watt_name = "postlens.lumensPerWatt";
inline constexpr const char* metres_per_unit_name = "postlens.metresPerUnit";
inline constexpr const char* key_time_name = "postlens.time_s";
inline constexpr const char* checksum_name = "postlens.headerChecksum";

inline constexpr const char* perspective_text = "perspective";
inline constexpr const char* orthographic_text = "orthographic";

}  // namespace postlens::attribute
