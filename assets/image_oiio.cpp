// The only file that knows OpenImageIO. Built as a module of its own: the library brings hundreds of shared objects,
// which programs that read no image should not wait for.
#include "assets/image_module.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <new>
#include <string>
#include <vector>

struct ImageReader {
    std::unique_ptr<OIIO::ImageInput> input;
    bool tiled;
    bool row_by_row;
    std::vector<unsigned char> row; // of all channels, where fewer are asked for
};

namespace {

constexpr int STRIP_ROWS = 64; // enough for the library's threads to share

void set_error(ImageError *error, const std::string &text) {
    std::string line = text.substr(0, text.find('\n'));
    snprintf(error->text, sizeof error->text, "%s", line.empty() ? "OpenImageIO gave no reason" : line.c_str());
}

// No exception may reach the C side.
template <typename Body> Result guarded(ImageError *error, Body body) {
    try {
        return body();
    } catch (const std::bad_alloc &) {
        set_error(error, "out of memory");
        return RESULT_MEMORY;
    } catch (const std::exception &exception) {
        set_error(error, exception.what());
    } catch (...) {
        set_error(error, "an unknown exception in OpenImageIO");
    }
    return RESULT_FORMAT;
}

ImageType type_of(const OIIO::ImageSpec &spec) {
    if (!spec.channelformats.empty())
        return IMAGE_OTHER;
    switch (spec.format.basetype) {
    case OIIO::TypeDesc::UINT8:
        return IMAGE_UINT8;
    case OIIO::TypeDesc::INT8:
        return IMAGE_INT8;
    case OIIO::TypeDesc::UINT16:
        return IMAGE_UINT16;
    case OIIO::TypeDesc::INT16:
        return IMAGE_INT16;
    case OIIO::TypeDesc::UINT32:
        return IMAGE_UINT32;
    case OIIO::TypeDesc::INT32:
        return IMAGE_INT32;
    case OIIO::TypeDesc::FLOAT:
        return IMAGE_FLOAT32;
    default: // 64-bit samples too: OpenImageIO 2.4 gives zeros for those in tiles and in rows that are no whole strip
        return IMAGE_OTHER;
    }
}

ImageSpec spec_of(const OIIO::ImageSpec &spec) {
    ImageSpec out = {};
    out.width = spec.width;
    out.height = spec.height;
    out.channels = spec.nchannels;
    out.type = type_of(spec);
    out.alpha_channel = spec.alpha_channel;
    out.tiled = spec.tile_width > 0;
    out.block_rows = out.tiled ? spec.tile_height : STRIP_ROWS;
    return out;
}

OIIO::ImageSpec open_hints() {
    OIIO::ImageSpec hints;
    hints["oiio:UnassociatedAlpha"] = 1; // a sample under alpha 0 must not become 0
    hints["oiio:RawColor"] = 1;
    return hints;
}

std::string last_error(const ImageReader *reader) {
    return reader && reader->input && reader->input->has_error() ? reader->input->geterror() : OIIO::geterror();
}

// What OpenImageIO 2.4 does wrong when it reads many rows of a TIFF at once: it drops what zlib says about damaged
// strips of 8 and 16 bits, and it loops where a strip claims to be longer than the image. Single rows go through
// libtiff, which reports. Where bands are stored apart, single rows are slow, and there the first mistake is not made.
bool must_read_row_by_row(const OIIO::ImageInput &input) {
    const OIIO::ImageSpec &spec = input.spec();
    if (spec.tile_width != 0 || std::string(input.format_name()) != "tiff")
        return false;
    bool small = spec.format == OIIO::TypeDesc::UINT8 || spec.format == OIIO::TypeDesc::UINT16;
    bool apart = spec.nchannels > 1 && spec.get_string_attribute("planarconfig") == "separate";
    int strip_rows = spec.get_int_attribute("tiff:RowsPerStrip");
    return (small && !apart) || strip_rows < 1 || strip_rows > spec.height;
}

Result open_reader(const char *path, const char *format, ImageReader **out, ImageSpec *spec, ImageError *error) {
    return guarded(error, [&] {
        auto reader = std::make_unique<ImageReader>();
        OIIO::ImageSpec native, hints = open_hints();
        if (format) {
            reader->input = OIIO::ImageInput::create(format);
            if (reader->input && !reader->input->open(path, native, hints)) {
                set_error(error, last_error(reader.get()));
                return RESULT_FORMAT;
            }
        } else {
            reader->input = OIIO::ImageInput::open(path, &hints);
            if (reader->input)
                native = reader->input->spec();
        }
        if (!reader->input || native.width < 1 || native.height < 1 || native.depth > 1 || native.nchannels < 1) {
            set_error(error, reader->input ? "it holds no flat image" : last_error(nullptr));
            return RESULT_FORMAT;
        }
        *spec = spec_of(native);
        reader->tiled = spec->tiled;
        reader->row_by_row = must_read_row_by_row(*reader->input);
        *out = reader.release();
        return RESULT_OK;
    });
}

bool read_single_rows(ImageReader *reader, int y0, int y1, int channels, OIIO::TypeDesc type, void *out) {
    const OIIO::ImageSpec &spec = reader->input->spec();
    size_t pixel_bytes = type.size() * size_t(spec.nchannels), wanted_bytes = type.size() * size_t(channels);
    reader->row.resize(pixel_bytes * size_t(spec.width));
    auto *to = static_cast<unsigned char *>(out);
    for (int y = y0; y < y1; y++) {
        if (!reader->input->read_scanline(y, spec.z, type, reader->row.data()))
            return false;
        const unsigned char *from = reader->row.data();
        for (int x = 0; x < spec.width; x++, from += pixel_bytes, to += wanted_bytes)
            std::copy_n(from, wanted_bytes, to);
    }
    return true;
}

bool read_many_rows(ImageReader *reader, int y0, int y1, int channels, OIIO::TypeDesc type, void *out) {
    const OIIO::ImageSpec &spec = reader->input->spec();
    if (reader->tiled)
        return reader->input->read_tiles(0, 0, spec.x, spec.x + spec.width, y0, y1, spec.z, spec.z + 1, 0, channels,
                                         type, out);
    return reader->input->read_scanlines(0, 0, y0, y1, spec.z, 0, channels, type, out);
}

Result read_rows(ImageReader *reader, int row_begin, int row_end, int channels, bool as_uint8, void *out,
                 ImageError *error) {
    return guarded(error, [&] {
        const OIIO::ImageSpec &spec = reader->input->spec();
        OIIO::TypeDesc type = as_uint8 ? OIIO::TypeDesc(OIIO::TypeDesc::UINT8) : spec.format;
        int y0 = spec.y + row_begin, y1 = spec.y + row_end;
        bool read = reader->row_by_row ? read_single_rows(reader, y0, y1, channels, type, out)
                                       : read_many_rows(reader, y0, y1, channels, type, out);
        // A truncated strip reads as success; only the message tells.
        if (!read || reader->input->has_error()) {
            set_error(error, last_error(reader));
            return RESULT_FORMAT;
        }
        return RESULT_OK;
    });
}

void close_reader(ImageReader *reader) {
    ImageError ignored;
    (void)guarded(&ignored, [&] {
        delete reader;
        return RESULT_OK;
    });
}

Result write_png(const char *path, int width, int height, int channels, const uint8_t *pixels, ImageError *error) {
    return guarded(error, [&] {
        auto output = OIIO::ImageOutput::create("png");
        if (!output) {
            set_error(error, OIIO::geterror());
            return RESULT_DEVICE;
        }
        OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
        spec["oiio:UnassociatedAlpha"] = 1;
        spec["Software"] = "Overfly";
        bool written = output->open(path, spec) && output->write_image(OIIO::TypeDesc::UINT8, pixels);
        written = output->close() && written;
        if (!written)
            set_error(error, output->geterror());
        return written ? RESULT_OK : RESULT_IO;
    });
}

const ImageModule MODULE = {IMAGE_MODULE_VERSION, open_reader, read_rows, close_reader, write_png};

} // namespace

extern "C" __attribute__((visibility("default"))) const ImageModule *overfly_image_module(void) {
    return &MODULE;
}
