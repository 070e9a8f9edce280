// SPDX-License-Identifier: Apache-2.0
// Mean colours of directions that were left out: predicted, factorised and evaluated as a
// material does, beside the nearest measured pair and barycentric interpolation over the
// lights that were measured under the same view.
//
//     restoration_bench                        a synthetic glossy material
//     restoration_bench MEASUREMENT            a BTF
//     restoration_bench MEANS.csv ANGLES.csv   view,light,R,G,B and index,theta,phi,…
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "figures.hpp"
#include "sateen/analysis/reflectance.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/open_measurement.hpp"
#include "support/directions.hpp"

namespace sateen::bench {
namespace {

struct Table {
    std::vector<Direction> views;
    std::vector<Direction> lights;
    std::vector<MeasuredAppearance> pairs;
    bool cosine_included = true;
};

Table synthetic() {
    Table t;
    t.views = t.lights = test::ubo2003_directions();
    for (std::size_t l = 0; l < 81; ++l)
        for (std::size_t v = 0; v < 81; ++v) {
            const auto a = to_vector(t.lights[l]);
            const auto b = to_vector(t.views[v]);
            const float cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            const float h = (a[2] + b[2]) / std::sqrt(2 + 2 * cosine);
            MeasuredAppearance m{v, l, {}};
            for (std::size_t c = 0; c < 3; ++c)
                m.encoded[c] =
                    std::cbrt(a[2] * (0.5F - 0.2F * static_cast<float>(c) +
                                      0.1F * a[0] * a[0] + 0.15F * std::pow(h, 20.0F)));
            t.pairs.push_back(m);
        }
    return t;
}

std::vector<std::vector<double>> read_csv(const std::string& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    std::vector<std::vector<double>> rows;
    while (std::getline(file, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream fields(line);
        std::vector<double>& row = rows.emplace_back();
        for (double value = 0; fields >> value;) row.push_back(value);
    }
    return rows;
}

Table from_csv(const std::string& means, const std::string& angles) {
    Table t;
    for (const auto& row : read_csv(angles))
        t.views.push_back(direction_from_degrees(static_cast<float>(row.at(1)),
                                                 static_cast<float>(row.at(2))));
    t.lights = t.views;
    for (const auto& row : read_csv(means)) {
        MeasuredAppearance m{
            static_cast<std::size_t>(row.at(0)), static_cast<std::size_t>(row.at(1)), {}};
        for (std::size_t c = 0; c < 3; ++c)
            m.encoded[c] = static_cast<float>(std::cbrt(row.at(2 + c)));
        t.pairs.push_back(m);
    }
    return t;
}

Table from_measurement(const std::string& path) {
    Table t;
    auto measurement = open_measurement({&path, 1}, {});
    if (!measurement) return t;
    const MeasurementInfo& info = (*measurement)->info();
    t.views = info.views;
    t.lights = info.lights;
    t.cosine_included = info.radiometry.cosine_included;
    t.pairs.resize(info.observations.size());
    const auto executor = make_executor(1);
    Progress progress;
    const auto pass = for_each_image(
        **measurement, true, *executor, progress, [&](std::size_t i, const Image& image) {
            const Observation& o = info.observations[i];
            t.pairs[i] = {o.view, o.light,
                          encode_appearance(image_moments(image.view()), info.bands)};
        });
    if (!pass || !info.has_directions()) t.pairs.clear();
    return t;
}

struct Errors {
    std::vector<double> values;
    void add(const EncodedAppearance& found, const EncodedAppearance& truth) {
        const auto lab = [](const EncodedAppearance& e) {
            const auto cube = [&](std::size_t c) {
                const auto x = static_cast<double>(std::max(0.0F, e[c]));
                return x * x * x;
            };
            return lab_from_linear_srgb(cube(0), cube(1), cube(2));
        };
        values.push_back(delta_e_2000(lab(found), lab(truth)));
    }
    [[nodiscard]] double mean() const {
        double sum = 0;
        for (const double v : values) sum += v;
        return sum / static_cast<double>(values.size());
    }
    [[nodiscard]] double p95() {
        std::sort(values.begin(), values.end());
        return values[static_cast<std::size_t>(0.95 *
                                               static_cast<double>(values.size() - 1))];
    }
};

EncodedAppearance nearest(const Table& t, const std::vector<MeasuredAppearance>& known,
                          const MeasuredAppearance& wanted) {
    const auto l = to_vector(t.lights[wanted.light]);
    const auto v = to_vector(t.views[wanted.view]);
    static std::vector<std::array<float, 3>> lights;
    static std::vector<std::array<float, 3>> views;
    if (lights.size() != t.lights.size()) {
        for (const Direction d : t.lights) lights.push_back(to_vector(d));
        for (const Direction d : t.views) views.push_back(to_vector(d));
    }
    const MeasuredAppearance* best = nullptr;
    float most = -3;
    for (const MeasuredAppearance& m : known) {
        const auto& a = lights[m.light];
        const auto& b = views[m.view];
        const float sum = a[0] * l[0] + a[1] * l[1] + a[2] * l[2] + b[0] * v[0] +
                          b[1] * v[1] + b[2] * v[2];
        if (sum > most) {
            most = sum;
            best = &m;
        }
    }
    return best->encoded;
}

// Linear values under the known lights of one view, which may be none.
class Barycentric {
  public:
    Barycentric(const Table& t, const std::vector<MeasuredAppearance>& known)
        : table_(t), of_view_(t.views.size()) {
        std::vector<std::vector<Direction>> lights(t.views.size());
        for (const MeasuredAppearance& m : known) {
            of_view_[m.view].push_back(m.encoded);
            lights[m.view].push_back(t.lights[m.light]);
        }
        for (const auto& set : lights) meshes_.push_back(DirectionMesh::create(set));
    }
    [[nodiscard]] EncodedAppearance at(const MeasuredAppearance& wanted) const {
        const auto& mesh = meshes_[wanted.view];
        EncodedAppearance e{};
        if (!mesh) return e;
        const DirectionWeights w = mesh->interpolate(table_.lights[wanted.light]);
        for (std::size_t c = 0; c < 3; ++c) {
            float sum = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const float root = of_view_[wanted.view][w.index[k]][c];
                sum += w.weight[k] * root * root * root;
            }
            e[c] = std::cbrt(sum);
        }
        return e;
    }

  private:
    const Table& table_;
    std::vector<std::vector<EncodedAppearance>> of_view_;
    std::vector<Result<DirectionMesh>> meshes_;
};

Figure measure(const Table& t, double share, double limit) {
    std::mt19937_64 engine(1);
    std::vector<MeasuredAppearance> known;
    std::vector<MeasuredAppearance> left;
    for (const MeasuredAppearance& m : t.pairs) {
        const double u = static_cast<double>(engine() >> 11U) * 0x1p-53;
        (u < share ? known : left).push_back(m);
    }
    const bool complete = left.empty();
    if (complete) left = known;
    const AppearanceGrid grid{t.views, t.lights, 4, t.cosine_included};
    Reflectance reflectance;
    const double seconds = processor_seconds([&] {
        const auto table = complete_appearance(grid, known);
        if (table) reflectance = factorise_appearance(grid, *table);
    });
    const Barycentric barycentric(t, known);
    Errors ours;
    Errors near;
    Errors mesh;
    std::size_t turn = 0;
    for (const MeasuredAppearance& m : left) {
        ours.add(encoded_appearance(reflectance, m.view, m.light), m.encoded);
        // The search for the nearest is long: of every fourth.
        if (!complete && turn++ % 4 == 0) near.add(nearest(t, known, m), m.encoded);
        if (!complete && share > 0.3) mesh.add(barycentric.at(m), m.encoded);
    }
    Figure figure{
        "mean Delta E, " + std::to_string(std::lround(100 * share)) + " % of pairs known",
        ours.mean(),
        "Delta E 2000",
        limit,
        Figure::Bound::at_most,
        {}};
    figure.details = {{"p95", ours.p95()},
                      {"pairs known", static_cast<double>(known.size())},
                      {"rank", static_cast<double>(reflectance.rank)},
                      {"seconds", seconds}};
    if (!near.values.empty())
        figure.details.insert(figure.details.end(),
                              {{"nearest", near.mean()}, {"nearest p95", near.p95()}});
    if (!mesh.values.empty())
        figure.details.insert(figure.details.end(), {{"barycentric", mesh.mean()},
                                                     {"barycentric p95", mesh.p95()}});
    return figure;
}

int run(int argc, char** argv) {
    const Table t = argc > 2   ? from_csv(argv[1], argv[2])
                    : argc > 1 ? from_measurement(argv[1])
                               : synthetic();
    if (t.pairs.empty()) {
        std::fprintf(stderr, "restoration_bench: nothing to read\n");
        return 1;
    }
    print("restoration", {measure(t, 1, 1), measure(t, 0.5, 1), measure(t, 0.1, 2),
                          measure(t, 0.01, 4)});
    return 0;
}

}  // namespace
}  // namespace sateen::bench

int main(int argc, char** argv) {
    return sateen::bench::run(argc, argv);
}
