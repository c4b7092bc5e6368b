// What the channels of another program's file belong to: a view and a layer, by the words of their names and
// of their part's name.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "records/foreign_file.h"

namespace postlens {

/// Words of names, in small letters, that say what a channel holds and not whose it is.
using PassWords = std::span<const std::string_view>;

inline constexpr std::string_view colour_words[]{"rgba",  "rgb",    "combined", "beauty",
                                                 "color", "colour", "image"};
inline constexpr std::string_view depth_words[]{"depth", "z", "zdepth", "depthz", "zbuffer", "zbuf"};
inline constexpr std::string_view alpha_words[]{"alpha", "a", "rgba"};
inline constexpr std::string_view id_words[]{"id", "ids", "object", "objectid", "indexob"};
inline constexpr std::string_view vector_words[]{"vector", "vectors", "forward", "motion", "velocity"};

/// A channel, or several of one pass, and whose they are.
///
/// Programs write the same things in another order: LAYER.depth.Z, depth.LAYER.Z, a part depth_LAYER with a
/// channel Z. So the words of the part's name and of the channel's name, without its last one, are a set, of
/// which the words of the pass and of the view are taken out; what is left is the layer.
struct ChannelGroup {
    std::size_t part = 0;
    std::string view;                ///< of the part or in the name; else the hero of `multiView`; else empty
    std::vector<std::string> layer;  ///< sorted, small letters; none: of the whole picture
    bool has_pass = false;           ///< whether a word of the pass was among the names
};

/// Whose the channels of a part are that begin with `prefix` (its dot included, empty: with nothing).
[[nodiscard]] ChannelGroup channel_group(const ForeignFile& file, std::size_t part, std::string_view prefix,
                                         PassWords pass);

/// The words of a name in small letters: what stands between characters that are no letters or digits.
[[nodiscard]] std::vector<std::string> words_of(std::string_view name);

/// One of several channels that could go with the colours.
struct GroupCandidate {
    ChannelGroup group;
    std::string name;  ///< what messages call it
    int rank = 0;      ///< lower is better where the layer decides nothing
};

struct GroupMatch {
    std::size_t candidate = 0;
    bool surmised = false;  ///< it is nobody's by its name, or that of the layer above, which has colours
};

/// The candidate that goes with colours of the group `own`: of the same view, of the same layer or of one
/// that holds it (fewest words missing, then the part of the colours, then the rank). Else, `surmised`, the
/// only one there is of this view or of none that belongs to no other colours (`pictures`: the groups of all
/// colours of the file). Absent otherwise: what is another view's or another layer's is not taken.
[[nodiscard]] std::optional<GroupMatch> match_group(std::span<const GroupCandidate> candidates,
                                                    const ChannelGroup& own,
                                                    std::span<const ChannelGroup> pictures);

}  // namespace postlens
