// The extension module postlens._postlens, below the public API in postlens/*.py.
#include <memory>
#include <optional>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <string>
#include <tuple>
#include <vector>

#include "apps/run_command.h"
#include "core/json_dump.h"
#include "pictures/encoded_picture.h"
#include "python/arrays.h"
#include "python/run_job.h"

namespace py = pybind11;

namespace postlens::python {
namespace {

/// The result of a command: its report `json`, and the images that it returns instead of writing them.
/// Warnings have a code, a text and the fraction of affected pixels.
struct Outcome {
    std::string json;
    py::object text;
    py::list pictures;
    std::vector<std::tuple<std::string, py::object, double>> warnings;
    int exit_code = 0;
};

Outcome run(std::vector<std::string> words, int threads, const py::object& progress,
            const std::shared_ptr<KeptFrame>& kept, bool pictures_stay) {
    Outcome out;
    CommandResult result;
    run_job(threads, progress,
            [&] { result = run_command(std::move(words), {.pictures_stay = pictures_stay, .kept = kept}); });
    out.json = json_dump(result.json);
    out.text = text_of(result.text);
    for (Image& image : result.pictures) {
        const std::optional<double> stops = image.exposure_stops;
        py::dict planes;
        for (const Image::Plane& p : image.planes) {
            py::array_t<float> values({image.height, image.width});
            std::copy(p.values.begin(), p.values.end(), values.mutable_data());
            planes[py::str(p.name)] = std::move(values);
        }
        out.pictures.append(py::make_tuple(array_of(std::move(image)), stops, std::move(planes)));
    }
    for (Warning& w : result.warnings) out.warnings.emplace_back(w.code, text_of(w.text), w.share);
    out.exit_code = static_cast<int>(result.exit_code);
    return out;
}

void write_picture(const std::filesystem::path& path, const Pixels& pixels,
                   const std::optional<double>& exposure_stops) {
    run_job(0, py::none(), [&] {
        check_image_path(path);
        write_image(path, image_of(pixels, exposure_stops));
    });
}

py::tuple read_picture(const std::filesystem::path& path) {
    Image image;
    run_job(0, py::none(), [&] { image = read_image(path); });
    const std::optional<double> stops = image.exposure_stops;
    return py::make_tuple(array_of(std::move(image)), stops);
}

py::bytes png(const Pixels& pixels, const std::optional<double>& exposure_stops) {
    std::string file;
    translated([&] { file = png_file(encoded_8bit(image_of(pixels, exposure_stops)), "picture.png"); });
    return py::bytes(file);
}

}  // namespace
}  // namespace postlens::python

PYBIND11_MODULE(_postlens, module) {
    using namespace postlens;
    using namespace postlens::python;
    module.doc() = "What postlens' Python code is made of.";
    module.attr("__version__") = POSTLENS_VERSION;
    py::class_<Outcome>(module, "Outcome")
        .def_readonly("json", &Outcome::json)
        .def_readonly("text", &Outcome::text)
        .def_readonly("pictures", &Outcome::pictures)
        .def_readonly("warnings", &Outcome::warnings)
        .def_readonly("exit_code", &Outcome::exit_code);
    py::class_<KeptFrame, std::shared_ptr<KeptFrame>>(module, "KeptFrame")
        .def(py::init([](const std::filesystem::path& path, bool salvage) {
                 return std::make_shared<KeptFrame>(path.string(),
                                                    salvage ? Damage::salvage : Damage::refuse);
             }),
             py::arg("path"), py::arg("salvage"));
    module.def("run", &run, py::arg("words"), py::arg("threads"), py::arg("progress"), py::arg("kept"),
               py::arg("pictures_stay"));
    module.def("is_sample_file", [](const std::filesystem::path& path) {
        bool found = false;
        translated([&] { found = SampleFileReader::is_sample_file(path); });
        return found;
    });
    module.def("write_picture", &write_picture, py::arg("path"), py::arg("pixels"),
               py::arg("exposure_stops"));
    module.def("read_picture", &read_picture, py::arg("path"));
    module.def("png", &png, py::arg("pixels"), py::arg("exposure_stops"));
    add_records(module);
}
