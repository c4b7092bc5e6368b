#include "apps/commands/merge_parts.h"
#include "apps/deliver.h"
#include "core/counted.h"
#include "core/job.h"
#include "core/progress.h"
#include "records/file/sample_file_header.h"
#include "records/lost_rows.h"
#include "records/sample_file.h"
#include "tracer/recording/trace_share.h"

namespace postlens {
namespace {

/// Exposure in stops that leaves radiance unchanged.
constexpr double as_stored = 0;

PartFacts facts_of(const std::string& name, const SampleFileReader& file) {
    PartFacts out{name, nlohmann::ordered_json::parse(file.header().made_by, nullptr, false), {}};
    if (!out.mark.is_object() || !out.mark.contains("share")) {
        fail(ExitCode::invalid_input,
             "{}: is no part (got a whole sample file; expected what trace --share has written)", name);
    }
    out.share = share_in(out.mark, name);
    return out;
}

}  // namespace

CommandResult merge_traces(const MergeOptions& options) {
    check_exr_path(options.output, "records");
    FoundParts found;
    std::map<int, std::string> ordered;
    PartFacts first;
    std::optional<SampleHeader> header;
    RecordCompression compression{};
    for (const std::string& name : options.parts) {
        const SampleFileReader file(name);
        const PartFacts facts = facts_of(name, file);
        if (!header) {
            first = facts;
            header = file.header();
            compression = file.compression();
        }
        check_same_work(first, facts);
        found.add(facts);
        SampleHeader same = file.header();
        same.made_by = header->made_by;
        if (header_checksum(same) != header_checksum(*header) || file.compression() != compression)
            fail(ExitCode::invalid_input, "{}: has another header than {}", name, first.name);
        ordered[facts.share.index] = name;
    }
    const int count = first.share.count;
    const std::vector<int> missing = found.missing(count, options.partial);
    header->made_by.clear();
    SampleFileWriter writer(options.output, *header, compression);
    const int o = header->overscan_px, y_begin = -o, y_end = header->height + o + 1, x_begin = -o,
              x_end = header->width + o + 1;
    const std::size_t instants = 1 + header->key_times_s.size();
    Progress progress("merge", static_cast<std::uint64_t>(y_end - y_begin) * instants);
    std::uint64_t records = 0;
    for (std::size_t instant = 0; instant < instants; ++instant) {
        if (instant > 0) writer.next_instant();
        RecordBand last;
        for (int i = 0; i < count; ++i) {
            const RowRange rows = rows_of_share({i, count}, y_begin, y_end);
            const auto part = ordered.find(i);
            std::optional<SampleFileReader> file;
            if (part != ordered.end()) file.emplace(part->second, Damage::refuse, as_stored);
            for (int y = rows.begin; y < rows.end;) {
                throw_if_interrupted();
                constexpr int rows_at_once = 64;
                const int end = file ? std::min(rows.end, y + rows_at_once) : y + 1;
                RecordBand band;
                if (file) {
                    file->read(y, end, band, instant);
                } else {
                    band = stand_in_row(y > y_begin ? &last : nullptr, x_begin, x_end, y);
                }
                writer.write(band);
                records += band.records.size();
                progress.advance(static_cast<std::uint64_t>(end - y));
                last = std::move(band);
                y = end;
            }
        }
    }
    const std::uint64_t bytes = writer.finish();
    CommandResult out;
    out.json = {{"parts", options.parts.size()},    {"of", count},        {"missing", missing},
                {"made_by", first.mark["made_by"]}, {"records", records}, {"bytes", bytes}};
    out.text = fmt::format("{}: {} from {} of {}", options.output, counted(records, "record"),
                           options.parts.size(), counted(count, "part"));
    if (!missing.empty()) {
        out.warnings.push_back(
            {"partial", fmt::format("parts are missing, their rows show nothing: {}", listed(missing, count)),
             static_cast<double>(missing.size()) / count});
    }
    return out;
}

}  // namespace postlens
