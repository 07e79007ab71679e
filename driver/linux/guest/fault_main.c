// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include <fcntl.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "driver/hvp_pci.h"

// Asks the model of the board for a fault, by a capability that no real board has
// (docs/pci-function.md), through the file that the kernel has of the function's configuration
// space. The access is made in its turn, behind what the guest has posted, and takes no time.
//
//   hvp-fault kind=lost-interrupt
//   hvp-fault kind=master-abort access=status count=2
//
// Ends with 0, with 2 where the words are refused, and with 3 where there is no such board.

enum { VENDOR_CAPABILITY = 0x09, CAPABILITY_BYTES = 16, VERSION = 1 };
enum { CAPABILITIES_AT = 0x34, COMMAND = 4, PLACE = 8, ANSWER = 12 };
enum { LONGEST = 255, MOST_PLACES = 256 };

static int read_word(int file, unsigned at, unsigned char word[4]) {
  return pread(file, word, 4, (off_t)at) == 4;
}

// The capability's place in a function's configuration space; 0: it has none.
static unsigned find_capability(int file) {
  unsigned char word[4];
  if (!read_word(file, 0, word) || (word[0] | word[1] << 8) != HVP_PCI_VENDOR_ID ||
      (word[2] | word[3] << 8) != HVP_PCI_DEVICE_ID || !read_word(file, CAPABILITIES_AT, word)) {
    return 0;
  }
  unsigned at = word[0];
  for (int i = 0; i < 48 && at != 0; ++i, at = word[1]) {
    if (!read_word(file, at, word)) return 0;
    if (word[0] == VENDOR_CAPABILITY && word[2] == CAPABILITY_BYTES && word[3] == VERSION)
      return at;
  }
  return 0;
}

// Sends the command with the zero behind it, a word at a time.
static int send_command(int file, unsigned at, const char* command) {
  const size_t bytes = strlen(command) + 1;
  for (size_t i = 0; i < bytes; i += 4) {
    char word[4] = {0};
    memcpy(word, command + i, bytes - i < 4 ? bytes - i : 4);
    if (pwrite(file, word, 4, (off_t)(at + COMMAND)) != 4) return 0;
  }
  return 1;
}

// Prints the answer, if there is one, behind the program's name.
static int print_answer(int file, unsigned at) {
  char text[4 * MOST_PLACES + 1] = "";
  for (unsigned i = 0; i < MOST_PLACES; ++i) {
    const unsigned char place[4] = {(unsigned char)i};
    unsigned char word[4];
    if (pwrite(file, place, 4, (off_t)(at + PLACE)) != 4 || !read_word(file, at + ANSWER, word)) {
      return 3;
    }
    memcpy(text + 4 * i, word, 4);
    if (memchr(word, 0, 4) != NULL) break;
  }
  if (text[0] == '\0') return 0;
  (void)fprintf(stderr, "hvp-fault: %s\n", text);
  return 2;
}

static int ask(const char* path, const char* command) {
  const int file = open(path, O_RDWR | O_CLOEXEC);
  if (file < 0) return -1;
  const unsigned at = find_capability(file);
  int result = -1;
  if (at != 0) result = send_command(file, at, command) ? print_answer(file, at) : 3;
  (void)close(file);
  return result;
}

int main(int argc, char** argv) {
  char command[LONGEST + 1] = "fault ";
  for (int i = 1; i < argc; ++i) {
    if (strlen(command) + strlen(argv[i]) + 2 > sizeof command) {
      (void)fprintf(stderr, "hvp-fault: expected at most %d characters\n", LONGEST);
      return 2;
    }
    if (i > 1) strcat(command, ",");
    strcat(command, argv[i]);
  }
  if (argc == 1) {
    (void)fprintf(stderr, "hvp-fault: expected KEY=VALUE… of [[fault]], such as kind=stuck-busy\n");
    return 2;
  }
  glob_t all;
  int result = -1;
  if (glob("/sys/bus/pci/devices/*/config", 0, NULL, &all) == 0) {
    for (size_t i = 0; i < all.gl_pathc && result < 0; ++i) result = ask(all.gl_pathv[i], command);
    globfree(&all);
  }
  if (result < 0) (void)fprintf(stderr, "hvp-fault: no board of hvp linux is here\n");
  return result < 0 ? 3 : result;
}
