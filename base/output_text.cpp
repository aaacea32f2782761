#include "base/output_text.h"

namespace headpin::base {

OutputText::OutputText(const std::filesystem::path& path)
    : file_(path.string(), {.overwrite = true, .durable = false}), out_(this) {
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  out_.exceptions(std::ios::badbit);  // so that the stream lets through what file_ throws
}

OutputText::int_type OutputText::overflow(int_type character) {
  sync();
  if (character != traits_type::eof()) sputc(traits_type::to_char_type(character));
  return traits_type::not_eof(character);
}

int OutputText::sync() {
  file_.write(pbase(), static_cast<std::size_t>(pptr() - pbase()));
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  return 0;
}

void OutputText::close() {
  sync();
  file_.commit();
}

}  // namespace headpin::base
