// SPDX-License-Identifier: Apache-2.0
// Tries the texture similarity. Two files or more: scores of the others against the
// first.
// `--rank` and files: each photograph's first corner against other corners, random phase
// noise and degradations; says where the order is not
// other crop < random phase < everything else.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "baselines/random_phase.hpp"
#include "sateen/analysis/quality.hpp"
#include "sateen/core/fft.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "support/degradations.hpp"

namespace sateen {
namespace {

void print(const std::string& name, const TextureScore& s) {
    std::printf(
        "%-24s colour %6.2f  power %6.2f  acf %6.2f  bands %6.2f  joint %6.2f  "
        "total %6.3f\n",
        name.c_str(), s.colour.score, s.power.score, s.autocovariance.score,
        s.subbands.score, s.joint.score, s.total);
}

Result<Image> random_phase_of(const Image& linear, std::uint64_t seed) {
    SATEEN_TRY(
        const Image noise,
        baselines::random_phase(test::encoded(linear), fft_size_at_most(linear.rows()),
                                fft_size_at_most(linear.cols()), seed));
    return test::through_eight_bits(noise);
}

Result<bool> rank(const std::string& path, std::size_t most, Executor& executor) {
    SATEEN_TRY(const Image photograph, read_image(path));
    const std::size_t rows = std::min(most, photograph.rows() / 2);
    const std::size_t cols = std::min(most, photograph.cols() / 2);
    const std::size_t down = photograph.rows() - rows;
    const std::size_t across = photograph.cols() - cols;
    using test::crop;
    const Image corner = crop(photograph, 0, 0, rows, cols);
    SATEEN_TRY(const TextureReference reference,
               TextureReference::create(corner, {}, executor));

    struct Candidate {
        std::string name;
        int rank;
        Image image;
    };
    SATEEN_TRY(Image phase_0, random_phase_of(corner, 0));
    SATEEN_TRY(Image phase_1, random_phase_of(corner, 1));
    std::vector<Candidate> candidates;
    candidates.push_back(
        {"crop to the right", 0, crop(photograph, 0, across, rows, cols)});
    candidates.push_back({"crop below", 0, crop(photograph, down, 0, rows, cols)});
    candidates.push_back(
        {"crop opposite", 0, crop(photograph, down, across, rows, cols)});
    candidates.push_back({"random phase", 1, std::move(phase_0)});
    candidates.push_back({"random phase", 1, std::move(phase_1)});
    candidates.push_back({"wrong colours", 2, test::wrong_colours(corner)});
    candidates.push_back({"negative", 2, test::negative(corner)});
    candidates.push_back({"shuffled", 2, test::shuffled(corner, 0)});
    candidates.push_back({"blurred, 1 px", 2, test::blurred(corner, 1)});
    candidates.push_back({"blurred, 3 px", 2, test::blurred(corner, 3)});
    candidates.push_back({"white noise", 2, test::white_noise_like(corner, 0)});

    std::printf("%s, %zux%zu\n", path.c_str(), cols, rows);
    std::array<double, 3> least = {1e9, 1e9, 1e9};
    std::array<double, 3> most_of = {0, 0, 0};
    for (const Candidate& candidate : candidates) {
        SATEEN_TRY(const TextureScore score,
                   reference.compare(candidate.image, executor));
        print(candidate.name, score);
        const auto k = static_cast<std::size_t>(candidate.rank);
        least[k] = std::min(least[k], score.total);
        most_of[k] = std::max(most_of[k], score.total);
    }
    const bool ordered = most_of[0] < least[1] && most_of[1] < least[2];
    std::printf("%s: crops %.2f-%.2f, random phase %.2f-%.2f, others from %.2f\n\n",
                ordered ? "ordered" : "NOT ORDERED", least[0], most_of[0], least[1],
                most_of[1], least[2]);
    return ordered;
}

Result<void> score_files(const std::vector<std::string>& paths, Executor& executor) {
    using Clock = std::chrono::steady_clock;
    SATEEN_TRY(const Image first, read_image(paths.front()));
    SATEEN_TRY(const ImageHeader header, read_image_header(paths[1]));
    const auto start = Clock::now();
    SATEEN_TRY(const TextureReference reference,
               TextureReference::create(first, {header.rows, header.cols}, executor));
    const std::chrono::duration<double> preparation = Clock::now() - start;
    std::fprintf(stderr, "prepared in %.2f s\n", preparation.count());
    for (std::size_t i = 1; i < paths.size(); ++i) {
        SATEEN_TRY(const Image candidate, read_image(paths[i]));
        const auto begin = Clock::now();
        SATEEN_TRY(const TextureScore score, reference.compare(candidate, executor));
        const std::chrono::duration<double> seconds = Clock::now() - begin;
        print(paths[i], score);
        SATEEN_TRY(const TextureCrossCheck check, cross_check(first, candidate));
        const SeamRatio seam = seam_ratio(candidate.view());
        std::printf("%-24s gk %.2f  blob %.2f  sw5 %.3f  seam %.2f %.2f  %.2f s\n", "",
                    check.gradient_kurtosis, check.blob, check.patches, seam.rows,
                    seam.cols, seconds.count());
    }
    return {};
}

Result<bool> run(const std::vector<std::string>& arguments) {
    const auto executor = make_executor(0);
    if (arguments.size() >= 2 && arguments.front() == "--rank") {
        constexpr std::size_t kMostPixels = 512;
        std::size_t failures = 0;
        for (std::size_t i = 1; i < arguments.size(); ++i) {
            SATEEN_TRY(const bool ordered, rank(arguments[i], kMostPixels, *executor));
            failures += ordered ? 0 : 1;
        }
        std::printf("%zu of %zu not ordered\n", failures, arguments.size() - 1);
        return failures == 0;
    }
    if (arguments.size() < 2) {
        return Error{
            Errc::invalid_argument,
            "usage: quality_rank REFERENCE CANDIDATE... | quality_rank --rank PHOTO..."};
    }
    SATEEN_CHECK(score_files(arguments, *executor));
    return true;
}

}  // namespace
}  // namespace sateen

int main(int argc, char** argv) {
    const auto result = sateen::run({argv + 1, argv + argc});
    if (!result) {
        std::fprintf(stderr, "%s\n", result.error().message.c_str());
        return 1;
    }
    return *result ? 0 : 1;
}
