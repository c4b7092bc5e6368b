// Part of SampleFileReader: finds and replaces damaged rows (Damage::salvage).
#include <algorithm>

#include "core/threads.h"
#include "records/file/sample_file_reader_impl.h"
#include "records/lost_rows.h"

namespace postlens {

using namespace layout;

/// Finds the rows that cannot be read, and marks them as lost. The summary of a lost row (number of records,
/// depths, checksum) is replaced by that of an empty row.
void SampleFileReader::Impl::find_lost_rows() {
    for (std::size_t i = 0; i < instants.size(); ++i) {
        Instant& of = instants[i];
        parallel_for(of.lost.size(), [&](std::size_t row) {
            if (of.lost[row] == 0) {
                try {
                    read_alone(i, window.y_min + static_cast<int>(row), workplaces->local());
                    return;
                } catch (const Error& e) {
                    if (e.code() != ExitCode::invalid_input) throw;
                }
            }
            of.lost[row] = 1;
            of.facts[row] = {};
        });
        const auto whole = static_cast<std::size_t>(std::count(of.lost.begin(), of.lost.end(), 0));
        if (i == 0 && whole * least_whole_share < of.lost.size()) {
            fail(ExitCode::invalid_input,
                 "{}: too damaged to salvage (got {} whole rows of {}; expected at least {})", file.name(),
                 whole, of.lost.size(), (of.lost.size() + least_whole_share - 1) / least_whole_share);
        }
    }
}

/// Replaces the unreadable rows at each recorded instant by samples of rays that hit nothing. If an instant
/// has no readable row, the instant is removed. Here, only the number of the replacing samples is stored for
/// each row. The samples themselves are made when the row is read.
void SampleFileReader::Impl::replace_lost_rows() {
    const auto nothing_left = [](const Instant& of) {
        return std::find(of.lost.begin(), of.lost.end(), 0) == of.lost.end();
    };
    for (const Instant& of : instants)
        if (nothing_left(of)) lost_instants_s.push_back(of.time_s);
    std::erase_if(instants, nothing_left);
    header.key_times_s.clear();
    for (std::size_t i = 1; i < instants.size(); ++i) header.key_times_s.push_back(instants[i].time_s);
    for (std::size_t i = 0; i < instants.size(); ++i) {
        Instant& of = instants[i];
        parallel_for(of.lost.size(), [&](std::size_t row) {
            if (of.lost[row] == 0) return;
            Workplace& work = workplaces->local();
            find_stand_ins(i, window.y_min + static_cast<int>(row), work);
            of.facts[row].records = static_cast<std::uint32_t>(work.stand_ins.size());
        });
        add_runs(i, of.lost, window.y_min, lost_runs);
    }
    count_records();
}

void SampleFileReader::Impl::read_alone(std::size_t instant, int y, Workplace& work) const {
    const ScanlineFacts& facts = instants[instant].facts[row_index(y)];
    const DeepChunk chunk = deep_chunk(instant, y);
    RecordBand& band = work.row;
    band.x_begin = window.x_min;
    band.x_end = window.x_max + 1;
    band.y_begin = y;
    band.y_end = y + 1;
    band.offsets.assign(static_cast<std::size_t>(band.width()) + 1, 0);
    band.offsets.back() = facts.records;
    band.records.resize(facts.records);
    read_row(y, facts, chunk, 0, work, band);
}

void SampleFileReader::Impl::find_stand_ins(std::size_t instant, int y, Workplace& work) const {
    const bool above = y > window.y_min && instants[instant].lost[row_index(y - 1)] == 0;
    if (above) read_alone(instant, y - 1, work);
    stand_in_for_row(above ? &work.row : nullptr, window.x_min, window.x_max + 1, y, work.stand_in_offsets,
                     work.stand_ins);
}

void SampleFileReader::Impl::place_stand_ins(std::size_t instant, int y, std::uint32_t base, Workplace& work,
                                             RecordBand& band) const {
    find_stand_ins(instant, y, work);
    // Row y is damaged, so its records are replaced by `work.stand_ins`, records of rays that hit nothing.
    // Their number was computed when the file was opened. If it is different now, the file was modified in
    // the meantime.
    if (work.stand_ins.size() != instants[instant].facts[row_index(y)].records)
        fail_damaged(y, "the file changed while it was read");
    std::copy(work.stand_ins.begin(), work.stand_ins.end(), band.records.begin() + base);
    const std::size_t first = band.pixel(band.x_begin, y);
    for (std::size_t i = 1; i + 1 < work.stand_in_offsets.size(); ++i)
        band.offsets[first + i] = base + work.stand_in_offsets[i];
}

}  // namespace postlens
