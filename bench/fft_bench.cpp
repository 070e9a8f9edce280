// SPDX-License-Identifier: Apache-2.0
// Real 2-D transforms against FFTW's measured plans: one thread, interleaved, minimum of
// many. One JSON object on stdout.
#include <fftw3.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>

#include "sateen/core/fft.hpp"

namespace {

using sateen::Fft2d;
using sateen::Image;

template <class F>
double milliseconds(const F& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> time =
        std::chrono::steady_clock::now() - start;
    return time.count();
}

struct Times {
    double forward = std::numeric_limits<double>::max();
    double inverse = std::numeric_limits<double>::max();

    void add(double forward_ms, double inverse_ms) {
        forward = std::min(forward, forward_ms);
        inverse = std::min(inverse, inverse_ms);
    }
};

void bench(int size, bool first) {
    const auto n = static_cast<std::size_t>(size);
    const Fft2d fft = *Fft2d::create(n, n);
    sateen::SerialExecutor executor;
    Image image(1, n, n);
    for (std::size_t i = 0; i < image.values().size(); ++i) {
        image.values()[i] = static_cast<float>(i * 2654435761U % 1024) - 512.0F;
    }
    sateen::SplitComplexPlane spectrum(n, fft.spectrum_cols());

    float* real = fftwf_alloc_real(n * n);
    fftwf_complex* half = fftwf_alloc_complex(n * (n / 2 + 1));
    fftwf_plan to_half = fftwf_plan_dft_r2c_2d(size, size, real, half, FFTW_MEASURE);
    fftwf_plan to_real = fftwf_plan_dft_c2r_2d(size, size, half, real, FFTW_MEASURE);
    std::ranges::copy(image.values(), real);

    Times ours;
    Times fftw;
    const int repeats = std::clamp(1024 * 1024 * 100 / (size * size), 20, 400);
    for (int i = 0; i < repeats; ++i) {
        const double f =
            milliseconds([&] { fft.forward(image.plane(0), spectrum.view(), executor); });
        const double b =
            milliseconds([&] { fft.inverse(spectrum.view(), image.plane(0), executor); });
        ours.add(f, b);
        const double fftw_f = milliseconds([&] { fftwf_execute(to_half); });
        const double fftw_b = milliseconds([&] { fftwf_execute(to_real); });
        fftw.add(fftw_f, fftw_b);
        // FFTW does not normalise: keep the numbers in range.
        std::ranges::copy(image.values(), real);
    }
    fftwf_destroy_plan(to_half);
    fftwf_destroy_plan(to_real);
    fftwf_free(real);
    fftwf_free(half);

    std::printf(
        "%s\n  {\"size\": %d, \"forward_ms\": %.3f, \"fftw_forward_ms\": %.3f, "
        "\"forward_ratio\": %.2f, \"inverse_ms\": %.3f, \"fftw_inverse_ms\": %.3f, "
        "\"inverse_ratio\": %.2f, \"ratio\": %.2f, \"limit\": 1.3}",
        first ? "" : ",", size, ours.forward, fftw.forward, ours.forward / fftw.forward,
        ours.inverse, fftw.inverse, ours.inverse / fftw.inverse,
        std::max(ours.forward / fftw.forward, ours.inverse / fftw.inverse));
    std::fflush(stdout);
}

}  // namespace

int main() {
    std::printf("{\"fft\": [");
    bool first = true;
    for (const int size : {512, 800, 1024, 2048}) {
        bench(size, first);
        first = false;
    }
    std::printf("\n]}\n");
}
