// terrain/dem/byte_stream.h: the bytes of a file, or of the one that a .gz or .zip archive holds, from begin to end.
// Bytes.
// A ByteStream owns its file. One thread at a time.
#pragma once
#include "base/base.h"

typedef struct ByteStream ByteStream;

// Recognises archives by their contents. `ending`: what the name of the member of a .zip ends with (".hgt");
// there must be exactly one. Every failure is logged: NOT_FOUND, IO, FORMAT (damaged), UNSUPPORTED (members).
MUST_USE Result byte_stream_open(const char *path, const char *ending, ByteStream **out);
void byte_stream_close(ByteStream **stream);

// Without folders and without the archive's own ending: "N49E020.hgt". Lives as long as the stream.
const char *byte_stream_name(const ByteStream *stream);
// Bytes after unpacking, as the file promises them; reading finds out.
int64_t byte_stream_size(const ByteStream *stream);

// Exactly `bytes` more. FORMAT: the file ends before, or is damaged.
MUST_USE Result byte_stream_read(ByteStream *stream, void *out, size_t bytes);
// Nothing may follow, and the archive's checksum must hold: else FORMAT.
MUST_USE Result byte_stream_finish(ByteStream *stream);
