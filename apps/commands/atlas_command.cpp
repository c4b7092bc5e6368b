#include "apps/commands/atlas_command.h"

#include "chart/atlas/atlas_page.h"
#include "core/counted.h"
#include "core/files/output_file.h"

namespace postlens {

CommandResult run_atlas_command(const AtlasOptions& options) {
    const std::filesystem::path folder = options.output;
    AtlasRun run;
    try {
        run = run_atlas(options.cases, folder, options.restart);
    } catch (const Error& e) {
        if (e.code() != ExitCode::interrupted) throw;
        fail(ExitCode::interrupted,
             "interrupted; {} holds what is finished, and the same command goes on from it", folder.string());
    }
    write_file(folder / "failures.md", atlas_markdown(run));
    write_file(folder / "index.html", atlas_html(run, folder));
    CommandResult out;
    out.json["cases"] = nlohmann::ordered_json::array();
    for (const AtlasEntry& e : run.entries) {
        nlohmann::ordered_json entry{{"name", e.what.name}, {"cause", e.what.cause}, {"set", e.what.set}};
        entry.update(to_json(e.result));
        out.json["cases"].push_back(std::move(entry));
    }
    out.json["kept"] = run.kept;
    out.json["broken"] = run.broken;
    out.json["page"] = (folder / "index.html").string();
    for (const std::string& line : run.broken) out.text += line + "\n";
    out.text += fmt::format("{}: {}, {} of them were there already, {} not as expected",
                            (folder / "index.html").string(), counted(run.entries.size(), "case"), run.kept,
                            run.broken.size());
    if (!run.broken.empty()) out.exit_code = ExitCode::comparison_failed;
    return out;
}

}  // namespace postlens
