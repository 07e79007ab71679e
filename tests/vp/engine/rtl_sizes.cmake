# Made by tests/rtl/rtl_sizes.py: sizes of the RTL engine, within what it is built for.
# One lane, and queues of two rows.
hvp_tested_size(narrow MatrixBits 9 VectorBits 13 CoefficientBits 10 Package 4 Partitions 3 Lanes 1 NodeBits 7 PackageBits 10 QueueBits 1 PhaseClocks 23 DivisionClocks 71 StaticBits 4 Preconditioner 0)
# Products that drop bits, and a preconditioner with the shortest pass.
hvp_tested_size(wide MatrixBits 16 VectorBits 20 CoefficientBits 18 Package 9 Partitions 7 Lanes 2 NodeBits 8 PackageBits 9 QueueBits 3 PhaseClocks 19 DivisionClocks 86 StaticBits 4 Preconditioner 1)
# The least latencies, the shortest words and one partition.
hvp_tested_size(least MatrixBits 8 VectorBits 12 CoefficientBits 8 Package 3 Partitions 1 Lanes 1 NodeBits 6 PackageBits 11 QueueBits 2 PhaseClocks 19 DivisionClocks 66 StaticBits 4 Preconditioner 1)
# As many partitions as there can be.
hvp_tested_size(many MatrixBits 12 VectorBits 16 CoefficientBits 16 Package 8 Partitions 16 Lanes 2 NodeBits 8 PackageBits 8 QueueBits 1 PhaseClocks 20 DivisionClocks 68 StaticBits 4 Preconditioner 0)
# Long divisions and passes, and the longest coefficients.
hvp_tested_size(long MatrixBits 14 VectorBits 18 CoefficientBits 24 Package 10 Partitions 4 Lanes 2 NodeBits 9 PackageBits 8 QueueBits 3 PhaseClocks 33 DivisionClocks 98 StaticBits 4 Preconditioner 1)
# Packages and groups that wait for the banks of d.
hvp_tested_size(stall MatrixBits 10 VectorBits 14 CoefficientBits 12 Package 8 Partitions 2 Lanes 2 NodeBits 7 PackageBits 9 QueueBits 1 PhaseClocks 19 DivisionClocks 67 StaticBits 4 Preconditioner 0 DirectionMemory stall)
# Two words of a group in each bank, and packages of six nodes.
hvp_tested_size(banks MatrixBits 9 VectorBits 13 CoefficientBits 10 Package 16 Partitions 2 Lanes 4 NodeBits 7 PackageBits 9 QueueBits 2 PhaseClocks 20 DivisionClocks 68 StaticBits 4 Preconditioner 0 DirectionMemory two_copies DirectionBanks 2)
# Rows one at a time, and groups that lie in some of the banks.
hvp_tested_size(rows MatrixBits 9 VectorBits 13 CoefficientBits 10 Package 7 Partitions 3 Lanes 2 NodeBits 7 PackageBits 10 QueueBits 2 PhaseClocks 21 DivisionClocks 68 StaticBits 4 Preconditioner 0 RowsInParallel 1 DirectionBanks 8)
# Rows two at a time.
hvp_tested_size(pairs MatrixBits 9 VectorBits 13 CoefficientBits 10 Package 4 Partitions 3 Lanes 4 NodeBits 7 PackageBits 10 QueueBits 2 PhaseClocks 20 DivisionClocks 68 StaticBits 4 Preconditioner 0 RowsInParallel 2 DirectionMemory stall DirectionBanks 4)
hvp_tested_size(drawn1 MatrixBits 8 VectorBits 25 CoefficientBits 23 Package 6 Partitions 11 Lanes 2 NodeBits 6 PackageBits 7 QueueBits 5 PhaseClocks 40 DivisionClocks 97 StaticBits 4 Preconditioner 1 RowsInParallel 2 DirectionBanks 2 DirectionMemory two_copies)
hvp_tested_size(drawn2 MatrixBits 10 VectorBits 19 CoefficientBits 8 Package 12 Partitions 11 Lanes 4 NodeBits 10 PackageBits 7 QueueBits 4 PhaseClocks 19 DivisionClocks 57 StaticBits 4 Preconditioner 0 RowsInParallel 1 DirectionBanks 8 DirectionMemory two_copies)
hvp_tested_size(drawn3 MatrixBits 16 VectorBits 30 CoefficientBits 16 Package 3 Partitions 7 Lanes 4 NodeBits 10 PackageBits 9 QueueBits 5 PhaseClocks 24 DivisionClocks 83 StaticBits 4 Preconditioner 0 RowsInParallel 1 DirectionBanks 4 DirectionMemory stall)
hvp_tested_size(drawn4 MatrixBits 15 VectorBits 25 CoefficientBits 9 Package 4 Partitions 1 Lanes 1 NodeBits 7 PackageBits 11 QueueBits 1 PhaseClocks 31 DivisionClocks 59 StaticBits 4 Preconditioner 1 RowsInParallel 1 DirectionBanks 8 DirectionMemory stall)
hvp_tested_size(drawn5 MatrixBits 13 VectorBits 29 CoefficientBits 14 Package 12 Partitions 10 Lanes 1 NodeBits 6 PackageBits 7 QueueBits 1 PhaseClocks 21 DivisionClocks 79 StaticBits 4 Preconditioner 1 RowsInParallel 2 DirectionBanks 4 DirectionMemory double_pumped)
hvp_tested_size(drawn6 MatrixBits 8 VectorBits 12 CoefficientBits 19 Package 16 Partitions 5 Lanes 1 NodeBits 6 PackageBits 7 QueueBits 1 PhaseClocks 22 DivisionClocks 74 StaticBits 4 Preconditioner 0 RowsInParallel 3 DirectionBanks 8 DirectionMemory stall)
hvp_tested_size(drawn7 MatrixBits 8 VectorBits 28 CoefficientBits 20 Package 13 Partitions 1 Lanes 4 NodeBits 10 PackageBits 10 QueueBits 1 PhaseClocks 19 DivisionClocks 90 StaticBits 4 Preconditioner 1 RowsInParallel 3 DirectionBanks 2 DirectionMemory stall)
hvp_tested_size(drawn8 MatrixBits 11 VectorBits 23 CoefficientBits 16 Package 7 Partitions 1 Lanes 1 NodeBits 9 PackageBits 10 QueueBits 4 PhaseClocks 22 DivisionClocks 83 StaticBits 4 Preconditioner 1 RowsInParallel 2 DirectionBanks 1 DirectionMemory two_copies)
hvp_tested_size(drawn9 MatrixBits 13 VectorBits 18 CoefficientBits 8 Package 3 Partitions 1 Lanes 4 NodeBits 6 PackageBits 12 QueueBits 1 PhaseClocks 20 DivisionClocks 63 StaticBits 4 Preconditioner 1 RowsInParallel 2 DirectionBanks 4 DirectionMemory two_copies)
hvp_tested_size(drawn10 MatrixBits 15 VectorBits 28 CoefficientBits 8 Package 11 Partitions 2 Lanes 2 NodeBits 8 PackageBits 9 QueueBits 3 PhaseClocks 31 DivisionClocks 71 StaticBits 4 Preconditioner 0 RowsInParallel 3 DirectionBanks 2 DirectionMemory stall)
hvp_tested_size(drawn11 MatrixBits 13 VectorBits 24 CoefficientBits 21 Package 6 Partitions 5 Lanes 4 NodeBits 9 PackageBits 9 QueueBits 3 PhaseClocks 19 DivisionClocks 98 StaticBits 4 Preconditioner 0 RowsInParallel 2 DirectionBanks 4 DirectionMemory double_pumped)
hvp_tested_size(drawn12 MatrixBits 12 VectorBits 12 CoefficientBits 24 Package 13 Partitions 11 Lanes 2 NodeBits 7 PackageBits 6 QueueBits 5 PhaseClocks 22 DivisionClocks 98 StaticBits 4 Preconditioner 1 RowsInParallel 3 DirectionBanks 8 DirectionMemory stall)
hvp_tested_size(drawn13 MatrixBits 11 VectorBits 12 CoefficientBits 11 Package 3 Partitions 2 Lanes 1 NodeBits 10 PackageBits 10 QueueBits 5 PhaseClocks 40 DivisionClocks 80 StaticBits 4 Preconditioner 1 RowsInParallel 3 DirectionBanks 2 DirectionMemory two_copies)
hvp_tested_size(drawn14 MatrixBits 16 VectorBits 13 CoefficientBits 24 Package 3 Partitions 13 Lanes 2 NodeBits 6 PackageBits 8 QueueBits 1 PhaseClocks 24 DivisionClocks 99 StaticBits 4 Preconditioner 0 RowsInParallel 1 DirectionBanks 8 DirectionMemory two_copies)
hvp_tested_size(drawn15 MatrixBits 10 VectorBits 12 CoefficientBits 8 Package 9 Partitions 5 Lanes 4 NodeBits 6 PackageBits 7 QueueBits 4 PhaseClocks 31 DivisionClocks 56 StaticBits 4 Preconditioner 0 RowsInParallel 3 DirectionBanks 4 DirectionMemory two_copies)
hvp_tested_size(drawn16 MatrixBits 12 VectorBits 25 CoefficientBits 16 Package 14 Partitions 4 Lanes 1 NodeBits 6 PackageBits 8 QueueBits 1 PhaseClocks 27 DivisionClocks 83 StaticBits 4 Preconditioner 1 RowsInParallel 3 DirectionBanks 2 DirectionMemory double_pumped)
hvp_tested_size(drawn17 MatrixBits 8 VectorBits 18 CoefficientBits 10 Package 10 Partitions 1 Lanes 1 NodeBits 9 PackageBits 10 QueueBits 3 PhaseClocks 27 DivisionClocks 73 StaticBits 4 Preconditioner 0 RowsInParallel 3 DirectionBanks 2 DirectionMemory stall)
hvp_tested_size(drawn18 MatrixBits 8 VectorBits 22 CoefficientBits 21 Package 12 Partitions 3 Lanes 2 NodeBits 8 PackageBits 8 QueueBits 1 PhaseClocks 22 DivisionClocks 93 StaticBits 4 Preconditioner 1 RowsInParallel 1 DirectionBanks 1 DirectionMemory two_copies)
hvp_tested_size(drawn19 MatrixBits 9 VectorBits 28 CoefficientBits 23 Package 6 Partitions 10 Lanes 1 NodeBits 8 PackageBits 8 QueueBits 3 PhaseClocks 27 DivisionClocks 96 StaticBits 4 Preconditioner 1 RowsInParallel 2 DirectionBanks 8 DirectionMemory stall)
hvp_tested_size(drawn20 MatrixBits 15 VectorBits 19 CoefficientBits 9 Package 15 Partitions 6 Lanes 2 NodeBits 10 PackageBits 7 QueueBits 3 PhaseClocks 22 DivisionClocks 60 StaticBits 4 Preconditioner 1 RowsInParallel 3 DirectionBanks 4 DirectionMemory stall)
# A preconditioner of blocks, whose words take nearly as long as six divisions.
hvp_tested_size(blocks MatrixBits 12 VectorBits 16 CoefficientBits 16 Package 8 Partitions 5 Lanes 2 NodeBits 9 PackageBits 10 QueueBits 4 PhaseClocks 20 DivisionClocks 68 StaticBits 4 Preconditioner 2)
# The same with the shortest words, where a row of P⁻¹ is longest beside its scale.
hvp_tested_size(shortblocks MatrixBits 8 VectorBits 12 CoefficientBits 8 Package 3 Partitions 1 Lanes 1 NodeBits 6 PackageBits 11 QueueBits 2 PhaseClocks 19 DivisionClocks 62 StaticBits 4 Preconditioner 2)
# The same with long words, four lanes and rows two at a time.
hvp_tested_size(wideblocks MatrixBits 16 VectorBits 18 CoefficientBits 12 Package 12 Partitions 7 Lanes 4 NodeBits 8 PackageBits 8 QueueBits 3 PhaseClocks 24 DivisionClocks 78 StaticBits 4 Preconditioner 2 RowsInParallel 2 DirectionMemory two_copies DirectionBanks 4)
