// SPDX-License-Identifier: Apache-2.0
// A libtiff handle on callbacks, with its messages caught instead of printed.
#pragma once

#include <tiffio.h>

#include <cstdarg>
#include <cstdio>

#include <array>
#include <memory>
#include <string>

namespace sateen::io {

/// Keeps the first error of a handle; warnings are dropped.
class TiffMessages {
  public:
    [[nodiscard]] std::string first() const {
        return first_.empty() ? "no reason given" : first_;
    }

    static int on_error(TIFF*, void* self, const char*, const char* format,
                        std::va_list arguments) {
        std::array<char, 256> text = {};
        std::vsnprintf(text.data(), text.size(), format, arguments);
        std::string& first = static_cast<TiffMessages*>(self)->first_;
        if (first.empty()) first = text.data();
        return 1;
    }
    static int on_warning(TIFF*, void*, const char*, const char*, std::va_list) {
        return 1;
    }

  private:
    std::string first_;
};

struct CloseTiff {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using TiffHandle = std::unique_ptr<TIFF, CloseTiff>;

struct TiffCallbacks {
    TIFFReadWriteProc read;
    TIFFReadWriteProc write;
    TIFFSeekProc seek;
    TIFFCloseProc close;
    TIFFSizeProc size;
};

/// \param client    passed to the callbacks; must outlive the handle, as must `messages`
inline TiffHandle open_tiff(const char* mode, void* client,
                            const TiffCallbacks& callbacks, TiffMessages& messages) {
    TIFFOpenOptions* const options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options, TiffMessages::on_error, &messages);
    TIFFOpenOptionsSetWarningHandlerExtR(options, TiffMessages::on_warning, nullptr);
    TIFF* const tiff = TIFFClientOpenExt("image", mode, client, callbacks.read,
                                         callbacks.write, callbacks.seek, callbacks.close,
                                         callbacks.size, nullptr, nullptr, options);
    TIFFOpenOptionsFree(options);
    return TiffHandle(tiff);
}

}  // namespace sateen::io
