// Prescriptions: formats and errors.
#include "lens/prescription/prescription.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "core/error.h"
#include "lens/prescription/first_order.h"
#include "lens/prescription/glass_catalogue.h"
#include "lens/prescription/read_prescription.h"
#include "tests/lens/lens_files.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::prescription_test {
namespace {

TEST(DatFiles, PlanesMayBeWrittenLikeStops) {
    // A plano-convex lens in front of its stop, and an achromat with a plane middle surface. The stop is the
    // plane that does not refract.
    for (const char* plane : {"0", "inf"}) {
        const Prescription lens =
            lens_of_text(std::string(plane) + " 4 1.5 20\n-40 2 1 20\n0 3 0 8\n60 3 1.6 20\n" + plane +
                             " 2 1.7 20\n-50 0 1 20\n",
                         "plano.dat");
        EXPECT_EQ(lens.stop(), 2U);
        EXPECT_EQ(lens.surfaces[0].curvature_per_mm, 0);
        EXPECT_FALSE(lens.surfaces[0].is_stop);
        EXPECT_EQ(lens.surfaces[4].curvature_per_mm, 0);
        EXPECT_NEAR(lens.index_after(4), 1.7, 1e-12);
    }
}

class PrescriptionFiles : public testing::Test {
  protected:
    std::string write(const std::string& name, const std::string& text) {
        const auto path = folder_.path() / name;
        std::ofstream(path, std::ios::binary) << text;
        return path.string();
    }
    // Checks that the file is rejected with a one-line message that contains `part`.
    void refused(const std::string& name, const std::string& text, const std::string& part) {
        const std::string path = write(name, text);
        expect_refused([&] { (void)read_prescription(path); }, ExitCode::invalid_input, part, path);
    }
    TemporaryFolder folder_;
};

constexpr const char* good_toml = R"([lens]
name = "test"
f_number = 4
[glass.mine]
sellmeier = [1.03961212, 0.231792344, 1.01046945, 0.00600069867, 0.0200179144, 103.560653]
[[surface]]
radius_mm = 50
conic = -0.5
even_asphere = [0, 1e-7]
thickness_mm = 5
glass = "mine"
aperture_diameter_mm = 20
[[surface]]
radius_mm = -50
thickness_mm = 2
aperture_diameter_mm = 20
[[surface]]
stop = true
aperture_diameter_mm = 15
)";

TEST_F(PrescriptionFiles, OurFormat) {
    const Prescription lens = read_prescription(write("a.toml", good_toml));
    EXPECT_EQ(lens.surfaces[0].line, 6);
    EXPECT_EQ(lens.surfaces[0].conic, -0.5);
    EXPECT_EQ(lens.surfaces[0].asphere[1], 1e-7);
    EXPECT_NEAR(lens.index_after(0), 1.5168, 1e-5);
    EXPECT_EQ(lens.surfaces[1].curvature_per_mm, -0.02);
    EXPECT_EQ(lens.stop(), 2U);
    EXPECT_NEAR(first_order(lens).f_number, 4, 1e-12);
    EXPECT_TRUE(is_prescription(folder_.path() / "a.toml"));
    EXPECT_FALSE(is_prescription(write("scene.toml", "[camera]\n")));
}

TEST_F(PrescriptionFiles, Utf16IsReadLikeUtf8) {
    const std::string text = "# lens\r\n50\r\n29.475 3.76 1.67 25.2\r\n0 1 0 10\r\n-80 0 1 20\r\n";
    const Prescription plain = read_prescription(write("a.dat", text));
    for (const bool little : {true, false}) {
        std::string wide = little ? "\xFF\xFE" : "\xFE\xFF";
        for (const char c : text) {
            wide += little ? c : '\0';
            wide += little ? '\0' : c;
        }
        const Prescription lens = read_prescription(write("b.dat", wide));
        ASSERT_EQ(lens.surfaces.size(), 3U);
        EXPECT_EQ(lens.stated_focal_length_mm, 50);
        EXPECT_EQ(first_order(lens).efl_mm, first_order(plain).efl_mm);
    }
}

TEST_F(PrescriptionFiles, NamesBecomeAscii) {
    // Older programs write Latin-1, which is not valid UTF-8 and which JSON would reject.
    EXPECT_EQ(read_prescription(write("a.dat", "# Z\xE4hler \x07\n50 1 1.5 9\n0 0 1 9\n")).name, "Z?hler ?");
}

TEST_F(PrescriptionFiles, SequenceCommands) {
    const std::string text =
        "RDM; LEN\nTITLE 'a; b ! c'\nDIM C\nFNO 4\nWL 656 588 486\nREF 2\nPRV\nPWL 656 588 486\n"
        "'own' 1.60 1.61 1.62\nEND\nSO 0 1e13\nS 5.0 &\n 0.5 'own'  ! remark\n K -1; A 1e-3\n CIR 1.2\n"
        "S -5.0 0.1 517642\nSTO\nS 0 9.5 AIR\nSI 0 -0.01\nGO\n";
    const Prescription lens = read_prescription(write("a.seq", text));
    ASSERT_EQ(lens.surfaces.size(), 3U);
    EXPECT_EQ(lens.name, "a; b ! c");
    EXPECT_NEAR(lens.surfaces[0].curvature_per_mm, 0.02, 1e-15);
    EXPECT_NEAR(lens.surfaces[0].thickness_mm, 5, 1e-12);
    EXPECT_NEAR(lens.surfaces[0].clear_radius_mm, 12, 1e-12);
    EXPECT_EQ(lens.surfaces[0].conic, -1);
    EXPECT_NEAR(lens.surfaces[0].asphere[1], 1e-6, 1e-18);  // 1e-3 / cm^3 in the file
    EXPECT_NEAR(lens.index_after(0), 1.61, 1e-12);
    EXPECT_NEAR(lens.surfaces[1].glass.index(d_line_nm), 1.517, 1e-12);
    EXPECT_EQ(lens.stop(), 1U);
    EXPECT_NEAR(*lens.film_distance_mm, 94.9, 1e-9);
}

TEST_F(PrescriptionFiles, SequenceAperturesAndGlassesInAnyOrder) {
    const std::string text =
        "DIM M\nEPD 5\nSO 0 1e13\nS 50 5 516800.641700; CIR CLR 8\n CIR EDG 9\nS -50 1\n CIR EDG 7\nSTO\n"
        "S 40 3 'late'\nS 0 20\n CIR S2 CLR 6\n ADX 0\nSI 0 0\nPRV\nPWL 656 588 486\n'late' 1.60 1.61 1.62\n"
        "'pairs' STS 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\nEND\nGO\n";
    const Prescription lens = read_prescription(write("a.seq", text));
    ASSERT_EQ(lens.surfaces.size(), 4U);
    EXPECT_NEAR(lens.surfaces[0].glass.index(d_line_nm), 1.5168, 1e-12);
    EXPECT_EQ(lens.surfaces[0].clear_radius_mm, 8);
    EXPECT_EQ(lens.surfaces[1].clear_radius_mm, 6);
    EXPECT_NEAR(lens.surfaces[2].glass.index(588), 1.61, 1e-12);
    // The Sellmeier coefficients of N-BK7 in both orders.
    for (const char* terms : {"1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653",
                              "1.03961212 0.231792344 1.01046945 0.00600069867 0.0200179144 103.560653"}) {
        const Prescription made =
            read_prescription(write("b.seq", std::string("EPD 5\nPRV\nPWL 550\n'G' GMS ") + terms +
                                                 "\nEND\nSO 0 1e13\nS 50 5 'G'\nSTO\nS -50 40\nSI 0 0\n"));
        EXPECT_EQ(made.surfaces[0].glass, *find_glass("N-BK7")) << terms;
    }
}

TEST_F(PrescriptionFiles, ZemaxAperturesInUtf16WithoutAMark) {
    const std::string text =
        "UNIT MM X W X CM MR CPMM\nENPD 4\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.02\n  DISZ 4\n"
        "  GLAS N-BK7 0 0\n  CLAP 0 5 0\n  DIAM 8 1\nSURF 2\n  CURV -0.02\n  DISZ 2\n  DIAM 8 1\n  FLAP 0 6 "
        "0\n"
        "SURF 3\n  CURV 0\n  DISZ 40\n  CLAP 0 3 0\n  OBDC 0 0\nSURF 4\n  DISZ 0\n";
    for (const bool big : {false, true}) {
        std::string wide;
        for (const char c : text) {
            if (big) wide.push_back('\0');
            wide.push_back(c);
            if (!big) wide.push_back('\0');
        }
        const Prescription lens = read_prescription(write("a.zmx", wide));
        EXPECT_EQ(lens.surfaces[0].clear_radius_mm, 5);
        EXPECT_EQ(lens.surfaces[1].clear_radius_mm, 6);
        EXPECT_EQ(lens.surfaces[2].clear_radius_mm, 3);  // a plane in air that limits rays
    }
}

TEST_F(PrescriptionFiles, ZemaxAspheres) {
    const std::string text =
        "UNIT CM X W X CM MR CPMM\nENPD 1\nWAVM 1 0.55 1\nPWAV 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n"
        "  TYPE EVENASPH\n  CURV 0.2\n  CONI -0.7\n  PARM 1 0.01\n  PARM 2 0.003\n  DISZ 0.4\n"
        "  GLAS ODD 1 0 1.5 60 0 0 0\n  DIAM 0.8 1\nSURF 2\n  TYPE STANDARD\n  CURV -0.1\n  DISZ 7\nSURF 3\n"
        "  DISZ 0\n";
    const Prescription lens = read_prescription(write("a.zmx", text));
    const Surface& s = lens.surfaces[0];
    EXPECT_NEAR(s.curvature_per_mm, 0.02, 1e-15);
    EXPECT_EQ(s.conic, -0.7);
    EXPECT_NEAR(s.asphere[0], 1e-3, 1e-15);  // 0.01 / cm in the file
    EXPECT_NEAR(s.asphere[1], 3e-6, 1e-18);  // 0.003 / cm^3 in the file
    EXPECT_NEAR(s.clear_radius_mm, 8, 1e-12);
    EXPECT_NEAR(s.glass.index(d_line_nm), 1.5, 1e-12);
    EXPECT_NEAR(first_order(lens).entrance_pupil_diameter_mm, 10, 1e-12);
    EXPECT_NEAR(*lens.film_distance_mm, 70, 1e-12);
}

// A Zemax file of one lens, with `system` before the surfaces and `medium` as the line of its glass.
std::string zemax_singlet(const std::string& system, const std::string& medium) {
    return "UNIT MM X W X CM MR CPMM\n" + system +
           "SURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.02\n  DISZ 4\n" + medium +
           "  DIAM 12\nSURF 2\n  CURV -0.02\n  DISZ 48\n  DIAM 12\nSURF 3\n  DISZ 0\n";
}

TEST_F(PrescriptionFiles, ZemaxGlassesThatTheCatalogueLacks) {
    // A model glass (1) is its numbers. Those of an unknown glass of a catalogue (0) count unless they are
    // Zemax's placeholder.
    const auto singlet = [this](const std::string& glass) {
        return read_prescription(write("a.zmx", zemax_singlet("ENPD 10\n", "  GLAS " + glass + "\n")));
    };
    const Prescription model = singlet("___BLANK 1 0 1.5 40 0 0");
    EXPECT_NEAR(model.index_after(0), 1.5, 1e-12);
    EXPECT_TRUE(model.notes.empty());
    const Prescription stated = singlet("S-LAH66 0 0 1.7725 4.96E+1 0 0");
    EXPECT_NEAR(stated.index_after(0), 1.7725, 1e-12);
    ASSERT_EQ(stated.notes.size(), 1U);
    EXPECT_NE(stated.notes[0].find(":9: the catalogue does not contain glass 'S-LAH66': the nd 1.7725"),
              std::string::npos)
        << stated.notes[0];
    EXPECT_NEAR(singlet("N-BK7 0 0 1.5 4.0E+1").index_after(0), 1.5168, 1e-5);
    refused("a.zmx", zemax_singlet("ENPD 10\n", "  GLAS S-LAH66 0 0 1.5 4.0E+1 0 0 0\n"),
            ":9: unknown glass (got 'S-LAH66'");
    refused("a.zmx", zemax_singlet("ENPD 10\n", "  GLAS MIRROR 0 0 1.5 4.0E+1 0 0 0\n"),
            ":9: mirrors are not supported");
}

TEST_F(PrescriptionFiles, ZemaxPupilPrecedesTheFNumber) {
    for (const char* system : {"ENPD 10\nFNUM 4 0\n", "FNUM 4 0\nENPD 10\n"}) {
        const Prescription lens = read_prescription(write("a.zmx", zemax_singlet(system, "  GLAS N-BK7\n")));
        EXPECT_NEAR(first_order(lens).entrance_pupil_diameter_mm, 10, 1e-12) << system;
    }
}

TEST_F(PrescriptionFiles, ZemaxFieldsCountOnlyAsAngles) {
    for (const char* fields : {"FTYP 1 0 3 3\nYFLN 0 7 100\n", "YFLN 0 7 100\nFTYP 3 0 3 3\n"}) {
        const std::string text = zemax_singlet(std::string("ENPD 10\n") + fields, "  GLAS N-BK7\n");
        EXPECT_TRUE(read_prescription(write("a.zmx", text)).field_angles_deg.empty()) << fields;
    }
    const std::string angles = zemax_singlet("ENPD 10\nFTYP 0 0 3 3\nYFLN 0 7 10 0\n", "  GLAS N-BK7\n");
    EXPECT_EQ(read_prescription(write("a.zmx", angles)).field_angles_deg, (std::vector<double>{7, 10}));
}

TEST_F(PrescriptionFiles, TheObjectIsInAir) {
    refused("a.zmx", "ENPD 5\nSURF 0\n  GLAS SILICA\n  DISZ 100\nSURF 1\n  STOP\n  CURV 0.02\nSURF 2\n",
            ":2: the object is not in air (got 'SILICA'");
    const std::string rest = "\nS 100 5 BK7\nSTO\nS -100 0\nSI 0 0\n";
    refused("a.seq", "RDM\nEPD 10\nSO 0 1e13 SILICA" + rest, ":3: the object is not in air (got 'SILICA'");
    refused("a.seq", "RDM\nEPD 10\nSO 0 1e13\nGLA SO 1.333:55" + rest, ":3: the object is not in air");
    EXPECT_EQ(read_prescription(write("a.seq", "RDM\nEPD 10\nSO 0 1e13 AIR" + rest)).surfaces.size(), 2U);
}

TEST_F(PrescriptionFiles, ClearRadiiEndWhereSurfacesMeet) {
    // Surfaces with radii of 15 mm and 1 mm of glass between them meet at sags of 0.5 mm, where
    // r^2 = 2 R s - s^2.
    const Prescription lens =
        read_prescription(write("a.dat", "15 1 1.5 20\n-15 1 1 18\n0 1 0 10\n80 0 1 20\n"));
    const double met = std::sqrt(2 * 15 * 0.5 - 0.25);
    EXPECT_NEAR(lens.surfaces[0].clear_radius_mm, met, 1e-9);
    EXPECT_NEAR(lens.surfaces[1].clear_radius_mm, met, 1e-9);
    EXPECT_EQ(lens.surfaces[3].clear_radius_mm, 10);
    ASSERT_EQ(lens.notes.size(), 1U);
    EXPECT_NE(lens.notes[0].find(":2: surfaces 1 and 2 cross at 3.841 mm from the axis"), std::string::npos)
        << lens.notes[0];
    EXPECT_TRUE(published_lens("rayoptics_singlet.seq").notes.empty());
}

TEST_F(PrescriptionFiles, BadTablesAreRefused) {
    const std::string front = "29.475 3.76 1.67 25.2\n", stop = "0 1 0 10\n", back = "-80 0 1 20\n";
    refused("a.dat", "", "empty");
    refused("a.dat", " \n\t\n", "empty");
    refused("a.dat", "# nothing\n50\n", "no surface");
    refused("a.dat", front + back, "no stop");
    refused("a.dat", front + stop + stop + back, ":3: the lens has 2 stops");
    refused("a.dat", "29.475 3.76 1.67 -25.2\n" + stop + back, ":1: clear aperture of surface 1");
    refused("a.dat", "29.475 3.76 1.67 0\n" + stop + back, ":1: clear aperture of surface 1");
    refused("a.dat", "29.475 3.76 0.9 25.2\n" + stop + back, "got 0.9; expected 1 to 5");
    refused("a.dat", "29.475 3.76 0 25.2\n" + stop + back, "got 0; expected 1 to 5");
    refused("a.dat", "29.475 -3.76 1.67 25.2\n" + stop + back, "thickness after surface 1 is negative");
    refused("a.dat", "29.475 nan 1.67 25.2\n" + stop + back, ":1: thickness is not a finite number");
    refused("a.dat", "29.475 3.76 1.67\n" + stop + back, ":1: not a row of the table (got 3 words");
    refused("a.dat", "ten 3.76 1.67 25.2\n" + stop + back, "got 'ten'");
    refused("a.dat", "0 0 1 10\n", "afocal");
    refused("a.dat", "15 0 1.5 20\n-15 1 1 20\n" + stop, ":2: surfaces 1 and 2 cross at 0 mm");
    refused("a.txt", front, "not a lens prescription");
    std::string many;
    for (int i = 0; i < 1'000'000; ++i) many += "100 1 1.5 20\n";
    refused("a.dat", many, ":501: too many surfaces");
}

TEST_F(PrescriptionFiles, BadTomlIsRefused) {
    const std::string good = good_toml;
    const auto with = [&good](const std::string& from, const std::string& to) {
        std::string out = good;
        out.replace(out.find(from), from.size(), to);
        return out;
    };
    refused("a.toml", with("radius_mm = 50", "radius_mm = 0"), ":7:13: surface 1: 'radius_mm' is 0");
    refused("a.toml", with("glass = \"mine\"", "glass = \"N-BK8\""), "unknown glass (got 'N-BK8'");
    refused("a.toml", with("glass = \"mine\"", "index = 0.9"), "'index' is out of range");
    refused("a.toml", with("glass = \"mine\"", "nd = 1.5"), "has no 'vd'");
    refused("a.toml", with("glass = \"mine\"", "index = 1.5\nnd = 1.5"), "cannot stand together");
    refused("a.toml", with("f_number = 4", "f_number = 0"), "'f_number' is out of range");
    refused("a.toml", with("aperture_diameter_mm = 20", "aperture_diameter_mm = -20"), "out of range");
    refused("a.toml", with("conic", "konic"), "nearest known key: 'conic'");
    refused("a.toml", with("stop = true", "stop = false"), "no stop");
    refused("a.toml", with("f_number = 4", "entrance_pupil_diameter_mm = 4\nf_number = 4"), "cannot stand");
    refused("a.toml", "[lens]\n", "no surface");
    refused("a.toml", "[[surface]", "not valid TOML");
    std::string many;
    for (int i = 0; i < 1'000'000; ++i) many += "[[surface]]\nindex=1.5\n";
    refused("a.toml", many, ":1001: too many surfaces");
    // Neither a pupil nor the stop defines the width of the aperture.
    std::string open = with("f_number = 4\n", "");
    open.replace(open.rfind("aperture_diameter_mm = 15\n"), 26, "");
    refused("a.toml", open, "nothing says how wide the stop is");
}

TEST_F(PrescriptionFiles, BadSequencesAreRefused) {
    for (const char* command : {"CIR OBS 2", "CIR HOL 2", "REX 2", "ELX 2", "ADX 0.1", "ADY 0.1", "ADE 1"}) {
        const std::string name = std::string(command).substr(0, std::string(command).find_last_of(' '));
        refused("a.seq", std::string("SO 0 1e10\nS 0.1 1 SF6\n") + command + "\n",
                name + " is not supported");
    }
    for (const char* command : {"OBSC 0 2", "SQAP 2 2", "ELAP 2 3", "OBDC 0 0.1"}) {
        refused("a.zmx", std::string("SURF 0\nSURF 1\n  ") + command + "\n",
                std::string(command).substr(0, 4) + " is not supported");
    }
    refused("a.zmx", "SURF 0\nSURF 1\n  CLAP 1 2 0\n", "a ring of CLAP is not supported");
    refused("a.seq", "PRV\nPWL 550\n'G' HRT 1 2 3\nEND\nSO 0 1e10\nS 0.1 1 'G'\n",
            "private glass 'G': line 3 is not understood (got the formula 'HRT'");
    refused("a.seq", "S 1 2 REFL\n", ":1: mirrors are not supported");
    // RMD states whether a surface refracts, RDX and CUX the shape in the other section. The others change
    // surfaces, or make them other than smooth and refracting.
    refused("a.seq", "SO 0 1e10\nS 1 2 SF6\nS 1 2\nRMD S2 REFL\n", ":4: mirrors are not supported");
    for (const char* command :
         {"RDX S1 5", "CUX S1 .1", "SPL S1", "HOE S1", "FRN S1", "DEL S1", "INS S1", "REV S1", "SCA SA 2"}) {
        refused("a.seq", std::string("SO 0 1e10\nS 0.1 1 SF6\n") + command + "\n",
                ":3: command " + std::string(command).substr(0, 3) + " is not supported");
    }
    EXPECT_EQ(read_prescription(write("a.seq", "EPD 2\nSO 0 1e10\nS 0.1 1 SF6\nRMD REFR\nS -.1 2\nSI\n"))
                  .surfaces.size(),
              2U);
    refused("a.seq", "STO\n", ":1: this command needs a surface before it");
    refused("a.seq", "SO 0 1e10\nS 0.1 1 XYZ\nSI\n", ":2: unknown glass (got 'XYZ'");
    refused("a.seq", "SO 0 1e10\nS 0.1 1 SF6\n", "no image");
    refused("a.seq", "SO 0 1e10\nS 0.1 1 SF6\nADE 3\n", "command ADE is not supported");
    refused("a.seq", "SO 0 1e10\nS 0.1 1 SF6\nS -.1 2\nSI\nS 1\n", "behind the image");
    refused("a.seq", "SO 0 1e10\nS 0.1 1 SF6\nTHI S9 3\n", "no such surface");
    refused("a.zmx", "SURF 0\nSURF 1\n  TYPE COORDBRK\n", ":3: this type of surface is not supported");
    refused("a.zmx", "UNIT FURLONG\n", "unknown unit");
    refused("a.zmx", "SURF 0\nSURF 1\n  GLAS MIRROR 0\n", "mirrors are not supported");
    refused("a.zmx", "SURF 0\n", "too few surfaces");
}

}  // namespace
}  // namespace postlens::test::prescription_test
