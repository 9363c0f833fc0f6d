/** Paths (lattice_path.h) whose pieces are any within their ranges, with planned speeds. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_PATH_H
#define JOULEPATH_TESTS_PROOF_ANY_PATH_H

#include <joulepath/ground.h>
#include <joulepath/lattice_path.h>

#include "tests/proof/any.h"

#define ANY_PIECES 3U

static struct jp_path_piece any_pieces[ANY_PIECES];

static void any_piece(struct jp_path_piece *piece)
{
    ANY(*piece);
    piece->length = any_between(1, JP_PIECE_LENGTH_MAX);
    piece->bend = any_between(-JP_PIECE_BEND_MAX, JP_PIECE_BEND_MAX);
    piece->kind = (enum jp_piece_kind)any_between(JP_PIECE_CURVE, JP_PIECE_TURN_RIGHT);
    piece->ground_left = (uint8_t)any_unsigned(JP_GROUND_CLASSES - 1U);
    piece->ground_right = (uint8_t)any_unsigned(JP_GROUND_CLASSES - 1U);
    piece->is_at_edge = any_bool();
    piece->is_joined = any_bool();
    piece->speed.cruise = any_between(1, JP_Q24(8));
    piece->speed.end = any_between(0, JP_Q24(8));
    piece->speed.acceleration = any_between(1, JP_Q24(64));
    piece->speed.brake_from = any_between(0, piece->length);
    piece->speed.blend = any_between(0, piece->length / 2);
}

static void any_path(struct jp_lattice_path *path)
{
    for (unsigned i = 0; i < ANY_PIECES; i++) {
        any_piece(&any_pieces[i]);
    }
    ANY(*path);
    path->pieces = any_pieces;
    path->places = (uint16_t)ANY_PIECES;
    path->count = (uint16_t)any_unsigned(ANY_PIECES);
}

#endif
