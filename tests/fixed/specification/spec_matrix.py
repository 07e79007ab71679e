"""The matrix in words, a contact that moves, and P⁻¹: docs/fixed-point.md."""

from spec_words import Settings, Vector, limit, nearest, two_to


class Matrix:
    """Words of A, by rows: columns and words of the entries that are stored, in nodes of three."""

    def __init__(self, row_begin: list[int], column: list[int], value: list[int]) -> None:
        self.nodes = len(row_begin) - 1
        self.blocks: list[dict[int, list[int]]] = [
            {column[k]: value[9 * k : 9 * k + 9] for k in range(row_begin[i], row_begin[i + 1])}
            for i in range(self.nodes)
        ]
        self.original = [dict(row) for row in self.blocks]
        self.contacts: set[int] = set()

    def entry(self, row: int, column: int) -> int:
        return self.blocks[row // 3][column // 3][3 * (row % 3) + column % 3]

    def diagonal(self) -> Vector:
        return [self.entry(i, i) for i in range(3 * self.nodes)]

    def times(self, words: Vector) -> Vector:
        """Exact."""
        return [
            sum(block[3 * c + e] * words[3 * j + e] for j, block in row.items() for e in range(3))
            for row in self.blocks
            for c in range(3)
        ]

    def row_magnitudes(self) -> Vector:
        return [
            sum(abs(block[3 * c + e]) for block in row.values() for e in range(3))
            for row in self.blocks
            for c in range(3)
        ]

    def static_shift(self) -> int:
        """What the host converts: "matrix-norm"."""
        norm = max(self.row_magnitudes(), default=0)
        m = 0
        while two_to(m) < norm:
            m += 1
        return min(m, 31)

    def set_contact(self, node: int) -> None:
        """Contact, with the mean of the diagonal."""
        diagonal = self.diagonal()
        mean = max(1, nearest(sum(diagonal), len(diagonal)))
        for other in self.blocks[node]:
            self.blocks[node][other] = [0] * 9
            self.blocks[other][node] = [0] * 9
        self.blocks[node][node] = [mean if e % 4 == 0 else 0 for e in range(9)]
        self.contacts.add(node)

    def restore(self, node: int) -> None:
        self.contacts.remove(node)
        for other, words in self.original[node].items():
            if other in self.contacts:
                continue
            self.blocks[node][other] = words
            self.blocks[other][node] = [words[3 * (e % 3) + e // 3] for e in range(9)]


class Preconditioner:
    """The loop: P⁻¹."""

    def __init__(self, settings: Settings, matrix: Matrix, flags: set[str]) -> None:
        self.k = settings.matrix_bits + 18
        self.words: list[list[Vector]] = []  # three rows of three a node
        for node in range(matrix.nodes):
            diagonal = [matrix.entry(3 * node + c, 3 * node + c) for c in range(3)]
            if 0 in diagonal:
                flags.add("zero-diagonal")
            if min(diagonal) < 0:
                flags.add("negative-curvature")
            if settings.method == "block-jacobi-pcg":
                inverse = self.inverse_block(matrix.blocks[node][node])
                if inverse is None:
                    if 0 not in diagonal:
                        flags.add("negative-curvature")
                    inverse = self.inverse_diagonal(diagonal, 30)
            else:
                inverse = self.inverse_diagonal(diagonal, 32)
            self.words.append(inverse)
        sums = [sum(map(abs, row)) for rows in self.words for row in rows]
        self.w = max(sums, default=0).bit_length()

    def inverse_diagonal(self, diagonal: Vector, bits: int) -> list[Vector]:
        inverse = [min(nearest(two_to(self.k), a), limit(bits)) if a > 0 else 0 for a in diagonal]
        return [[inverse[r] if r == c else 0 for c in range(3)] for r in range(3)]

    def inverse_block(self, block: Vector) -> list[Vector] | None:
        b = [[block[3 * min(r, c) + max(r, c)] for c in range(3)] for r in range(3)]

        def cofactor(r: int, c: int) -> int:
            i, j = [e for e in range(3) if e != r]
            m, n = [e for e in range(3) if e != c]
            minor = b[i][m] * b[j][n] - b[i][n] * b[j][m]
            return minor if (r + c) % 2 == 0 else -minor

        determinant = sum(b[0][c] * cofactor(0, c) for c in range(3))
        if b[0][0] <= 0 or b[0][0] * b[1][1] - b[0][1] ** 2 <= 0 or determinant <= 0:
            return None
        inverse = [
            [nearest(cofactor(c, r) * two_to(self.k), determinant) for c in range(3)]
            for r in range(3)
        ]
        most = max(abs(word) for row in inverse for word in row)
        halvings = 0
        while most >> halvings > limit(30):
            halvings += 1
        return [[(abs(w) >> halvings) * (1 if w > 0 else -1) for w in row] for row in inverse]

    def sums(self, r: Vector) -> Vector:
        return [
            sum(row[c] * r[3 * node + c] for c in range(3))
            for node, rows in enumerate(self.words)
            for row in rows
        ]
