#include "driver/linux/guest/servo_frames.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "driver/linux/hvp_ioctl.h"

enum { HEAD_WORDS = 8, CONFIG_WORDS = 20 };
// More than any board's matrix takes, and few enough that no sum of them leaves 64 bits.
enum { MOST_NODES = 65535, MOST_BLOCKS = 1 << 26 };

static bool refuse(const char* path, const char* what) {
  (void)fprintf(stderr, "hvp-servo: %s: %s\n", path, what);
  return false;
}

static uint32_t from_file(const uint8_t* bytes) {
  return bytes[0] | (uint32_t)bytes[1] << 8U | (uint32_t)bytes[2] << 16U |
         (uint32_t)bytes[3] << 24U;
}

static bool read_words(struct servo_frames* frames, FILE* file, const char* path) {
  struct stat status;
  if (fstat(fileno(file), &status) != 0) return refuse(path, strerror(errno));
  if (!S_ISREG(status.st_mode)) return refuse(path, "expected a regular file");
  const size_t bytes = (size_t)status.st_size;
  if (bytes % sizeof(uint32_t) != 0) return refuse(path, "expected words of four bytes");
  frames->count = bytes / sizeof(uint32_t);
  frames->words = malloc(bytes == 0 ? 1 : bytes);
  if (frames->words == NULL) return refuse(path, "too large for this machine's memory");
  if (fread(frames->words, sizeof(uint32_t), frames->count, file) != frames->count) {
    return refuse(path, "cannot be read");
  }
  for (size_t i = 0; i < frames->count; ++i) {
    frames->words[i] = from_file((const uint8_t*)&frames->words[i]);
  }
  return true;
}

static uint32_t take(struct servo_frames* frames) { return frames->words[frames->at++]; }

static uint64_t take_long(struct servo_frames* frames) {
  const uint32_t low = take(frames);
  return (uint64_t)take(frames) << 32U | low;
}

static const int32_t* take_elements(struct servo_frames* frames, size_t n) {
  const int32_t* elements = (const int32_t*)&frames->words[frames->at];
  frames->at += n;
  return elements;
}

static bool has(const struct servo_frames* frames, uint64_t words) {
  return words <= frames->count - frames->at;
}

static void take_config(struct servo_frames* frames) {
  struct hvp_solver_config* config = &frames->config;
  config->method = (hvp_method)take(frames);
  config->start = (hvp_start_from)take(frames);
  config->iterations = take(frames);
  config->stop_residual = take_long(frames);
  config->replace_every = take(frames);
  config->static_shift = take(frames);
  const uint32_t flags = take(frames);
  config->dynamic_scaling = (flags & HVP_IOC_C_DYNAMIC_SCALING) != 0U;
  config->scaling_up_only = (flags & HVP_IOC_C_SCALING_UP_ONLY) != 0U;
  config->fixed_coefficients = (flags & HVP_IOC_C_FIXED_COEFFICIENTS) != 0U;
  config->one_a_word = (flags & HVP_IOC_C_ONE_A_WORD) != 0U;
  config->wrap_overflow = (flags & HVP_IOC_C_WRAP_OVERFLOW) != 0U;
  config->reject_saturated = (flags & HVP_IOC_C_REJECT_SATURATED) != 0U;
  config->headroom_bits = take(frames);
  config->scaling_threshold = take(frames);
  config->scaling_step = take(frames);
  config->matrix_bits = take(frames);
  config->vector_bits = take(frames);
  config->rhs_bits = take(frames);
  config->scalar_bits = take(frames);
  config->coefficient_bits = take(frames);
  config->alpha_fraction = take(frames);
  config->beta_fraction = take(frames);
  config->division_rounding = (hvp_round)take(frames);
  config->shift_rounding = (hvp_round)take(frames);
}

// Whether the updates and b of a frame are whole; goes behind them.
static bool skip_frame(struct servo_frames* frames) {
  if (!has(frames, 1)) return false;
  for (uint32_t left = take(frames); left > 0U; --left) {
    if (!has(frames, 3)) return false;
    const uint32_t kind = take(frames);
    (void)take(frames);
    const uint32_t number = take(frames);
    if (kind == SERVO_CONSTRAIN) continue;
    if (kind != SERVO_RESTORE || !has(frames, (uint64_t)9 * number)) return false;
    frames->at += (size_t)9 * number;
  }
  const size_t n = (size_t)3 * frames->matrix.nodes;
  if (!has(frames, n)) return false;
  frames->at += n;
  return true;
}

static bool look_through(struct servo_frames* frames, const char* path) {
  if (!has(frames, HEAD_WORDS + CONFIG_WORDS) || take(frames) != SERVO_FRAMES_MAGIC) {
    return refuse(path, "expected a file of frames, which begins with HVPF");
  }
  if (take(frames) != SERVO_VERSION) return refuse(path, "expected version 1");
  struct hvp_matrix* matrix = &frames->matrix;
  matrix->nodes = take(frames);
  matrix->blocks = take(frames);
  frames->frames = take(frames);
  frames->period_ns = take_long(frames);
  (void)take(frames);
  if (frames->period_ns == 0U || frames->period_ns > 1000000000U) {
    return refuse(path, "expected a period of 1 ns to 1 s");
  }
  if (matrix->nodes > MOST_NODES || matrix->blocks > MOST_BLOCKS) {
    return refuse(path, "expected a matrix that a board can have");
  }
  take_config(frames);
  if (!has(frames, (uint64_t)matrix->nodes + 1U + (uint64_t)10 * matrix->blocks)) {
    return refuse(path, "ends within the matrix");
  }
  matrix->row_begin = take_elements(frames, (size_t)matrix->nodes + 1U);
  matrix->column = take_elements(frames, matrix->blocks);
  matrix->value = take_elements(frames, (size_t)9 * matrix->blocks);
  const size_t first = frames->at;
  for (uint32_t k = 0; k < frames->frames; ++k) {
    if (!skip_frame(frames)) return refuse(path, "ends within a frame, or has an unknown update");
  }
  if (frames->at != frames->count) return refuse(path, "goes on behind the last frame");
  frames->at = first;
  return true;
}

bool servo_open_frames(struct servo_frames* frames, const char* path) {
  *frames = (struct servo_frames){.words = NULL};
  FILE* file = fopen(path, "rb");
  if (file == NULL) return refuse(path, strerror(errno));
  const bool good = read_words(frames, file, path) && look_through(frames, path);
  (void)fclose(file);
  if (!good) servo_close_frames(frames);
  return good;
}

void servo_close_frames(struct servo_frames* frames) {
  free(frames->words);
  frames->words = NULL;
}

uint32_t servo_take_updates(struct servo_frames* frames) { return take(frames); }

struct servo_update servo_take_update(struct servo_frames* frames) {
  struct servo_update update = {.kind = take(frames)};
  update.node = take(frames);
  const uint32_t number = take(frames);
  if (update.kind == SERVO_CONSTRAIN) {
    update.diagonal = (int32_t)number;
  } else {
    update.blocks = number;
    update.values = take_elements(frames, (size_t)9 * number);
  }
  return update;
}

const int32_t* servo_take_rhs(struct servo_frames* frames) {
  return take_elements(frames, (size_t)3 * frames->matrix.nodes);
}

static bool put(FILE* file, uint32_t word) {
  const uint8_t bytes[4] = {(uint8_t)word, (uint8_t)(word >> 8U), (uint8_t)(word >> 16U),
                            (uint8_t)(word >> 24U)};
  return fwrite(bytes, sizeof bytes, 1, file) == 1;
}

static bool put_long(FILE* file, uint64_t number) {
  return put(file, (uint32_t)number) && put(file, (uint32_t)(number >> 32U));
}

bool servo_write_head(FILE* file, const struct servo_frames* frames) {
  return put(file, SERVO_OUTPUT_MAGIC) && put(file, SERVO_VERSION) &&
         put(file, frames->matrix.nodes) && put(file, frames->frames);
}

bool servo_write_frame(FILE* file, const struct servo_record* record, const int32_t* u, size_t n) {
  bool good = put_long(file, record->due) && put_long(file, record->woken) &&
              put_long(file, record->started) && put_long(file, record->ended) &&
              put_long(file, record->read) && put(file, record->status) && put(file, record->flags);
  for (size_t i = 0; good && i < n; ++i) good = put(file, (uint32_t)u[i]);
  return good;
}
