#include "python/arrays.h"

#include <memory>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <utility>

#include "core/error.h"
#include "python/run_job.h"
#include "records/sample_file.h"

namespace py = pybind11;

namespace postlens::python {
namespace {

/// The records (surface points) of a sample file at one instant. Each member of `Record` becomes a numpy
/// array, which shares the memory of the records and keeps it alive.
class Records {
  public:
    explicit Records(RecordBand band) : band_(std::move(band)) {}

    [[nodiscard]] const RecordBand& band() const { return band_; }

    template <typename Value>
    [[nodiscard]] static py::array column(const std::shared_ptr<Records>& records, Value Record::*member) {
        return view<Value>(records, members(records, member), {}, {});
    }
    [[nodiscard]] static py::array column(const std::shared_ptr<Records>& records, NodePath Record::*member) {
        static_assert(sizeof(NodePath) == sizeof(std::uint32_t));
        return view<std::uint32_t>(records, members(records, member), {}, {});
    }
    [[nodiscard]] static py::array matrices(const std::shared_ptr<Records>& records) {
        static_assert(sizeof(Mat2) == 4 * sizeof(float));
        return view<float>(records, members(records, &Record::w), {2, 2}, {8, 4});
    }
    [[nodiscard]] static py::array offsets(const std::shared_ptr<Records>& records) {
        const auto& offsets = records->band_.offsets;
        return read_only(py::array_t<std::uint32_t>({offsets.size()}, {sizeof(std::uint32_t)}, offsets.data(),
                                                    py::cast(records)));
    }

  private:
    template <typename Member>
    [[nodiscard]] static const void* members(const std::shared_ptr<Records>& records, Member member) {
        const auto& all = records->band_.records;
        return all.empty() ? nullptr : static_cast<const void*>(&(all.front().*member));
    }
    /// Returns a numpy array with one field of all records (surface hits) of the file, without copying them.
    /// Each element is a value or an array of the given shape. `first` is the address of the field in the
    /// first record.
    template <typename Value>
    [[nodiscard]] static py::array view(const std::shared_ptr<Records>& records, const void* first,
                                        std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides) {
        const auto count = static_cast<py::ssize_t>(records->band_.records.size());
        shape.insert(shape.begin(), count);
        strides.insert(strides.begin(), static_cast<py::ssize_t>(sizeof(Record)));
        if (count == 0) return py::array_t<Value>(shape);
        return read_only(
            py::array_t<Value>(shape, strides, static_cast<const Value*>(first), py::cast(records)));
    }
    [[nodiscard]] static py::array read_only(py::array array) {
        array.attr("setflags")(py::arg("write") = false);
        return array;
    }

    RecordBand band_;
};

std::shared_ptr<Records> read_records(const std::filesystem::path& path, std::size_t key, bool salvage) {
    std::shared_ptr<Records> out;
    run_job(0, py::none(), [&] {
        // An exposure of 0 stops gives the radiance as stored.
        const SampleFileReader file(path, salvage ? Damage::salvage : Damage::refuse, 0.0);
        if (key >= file.instants()) {
            fail(ExitCode::wrong_arguments, "key: the file has no such instant (got {}; expected 0 to {})",
                 key, file.instants() - 1);
        }
        RecordBand band;
        file.read(file.y_begin(), file.y_end(), band, key);
        out = std::make_shared<Records>(std::move(band));
    });
    return out;
}

}  // namespace

py::array array_of(Image image) {
    const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
    if (image.alpha.empty()) {
        auto owner = std::make_unique<std::vector<float>>(std::move(image.rgb));
        const float* first = owner->data();
        const py::capsule keeper(owner.release(),
                                 [](void* p) { delete static_cast<std::vector<float>*>(p); });
        return py::array_t<float>({height, width, std::size_t{3}}, first, keeper);
    }
    py::array_t<float> out({height, width, std::size_t{4}});
    float* to = out.mutable_data();
    for (std::size_t i = 0; i < width * height; ++i) {
        for (std::size_t c = 0; c < 3; ++c) *to++ = image.rgb[3 * i + c];
        *to++ = image.alpha[i];
    }
    return out;
}

Image image_of(const Pixels& pixels, const std::optional<double>& exposure_stops) {
    const auto height = pixels.shape(0), width = pixels.shape(1), channels = pixels.shape(2);
    Image out(static_cast<int>(width), static_cast<int>(height));
    out.exposure_stops = exposure_stops;
    const float* from = pixels.data();
    if (channels == 4) out.alpha.resize(out.rgb.size() / 3);
    for (std::size_t i = 0; i < out.rgb.size() / 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * i + c] = *from++;
        if (channels == 4) out.alpha[i] = *from++;
    }
    return out;
}

void add_records(py::module_& module) {
    py::class_<Records, std::shared_ptr<Records>> records(
        module, "Records",
        "The records of one instant, one value a record in each column, in order of their pixels.\n\n"
        "The pixel in row i and column j of the traced raster, overscan included, has the records\n"
        "offsets[k] to offsets[k + 1], k = i * columns + j. Arrays are views and cannot be written.");
    const auto column = [&](const char* name, auto member, const char* doc) {
        records.def_property_readonly(
            name, [member](const std::shared_ptr<Records>& r) { return Records::column(r, member); }, doc);
    };
    column("x", &Record::x, "Raster position, px to the right; pixel i covers i to i + 1. float32");
    column("y", &Record::y, "Raster position, px down. float32");
    column("z", &Record::z,
           "z', the length of the path from the lens, m; infinite where nothing was hit. float32");
    column("r", &Record::r, "Radiance, red. float32");
    column("g", &Record::g, "Radiance, green. float32");
    column("b", &Record::b, "Radiance, blue. float32");
    column("id", &Record::id, "The object; 0: nothing. uint32");
    column("path", &Record::path,
           "The node's bounces, two bits each from the lowest: 1 reflected, 2 transmitted. uint32");
    column("layer", &Record::layer, "0: visible from the pinhole; n: the n-th surface behind. uint32");
    column(
        "bend", &Record::w_bend,
        "By how much W errs at a distance from the lens's centre, 1/m^2; infinite: other points of the lens "
        "do not see the node by this path. float32");
    column("mark", &Record::mark, "1: texture finer than its samples. uint8");
    records.def_property_readonly(
        "w", &Records::matrices,
        "How a node's image moves with the point of the lens, 1/m, (records, 2, 2). float32");
    records.def_property_readonly("offsets", &Records::offsets, "(rows * columns + 1). uint32");
    records.def_property_readonly("rows", [](const Records& r) { return r.band().height(); });
    records.def_property_readonly("columns", [](const Records& r) { return r.band().width(); });
    records.def_property_readonly(
        "x_begin", [](const Records& r) { return r.band().x_begin; },
        "The first column's place on the raster, px: minus the overscan.");
    records.def_property_readonly(
        "y_begin", [](const Records& r) { return r.band().y_begin; },
        "The first row's place on the raster, px.");
    records.def("__len__", [](const Records& r) { return r.band().records.size(); });
    module.def("read_records", &read_records, py::arg("path"), py::arg("key"), py::arg("salvage"));
}

}  // namespace postlens::python
