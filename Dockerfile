# slipjump in a container: docs/howto/docker.md
FROM python:3.11-slim AS build
WORKDIR /src
COPY pyproject.toml constraints.txt README.md CHANGELOG.md LICENSE ./
COPY agent agent
COPY connectors connectors
COPY simulators simulators
COPY config config
RUN python -m venv /opt/slipjump \
 && /opt/slipjump/bin/pip install --no-cache-dir -c constraints.txt .
# kernels are compiled here, so that the first window does not wait for it
RUN NUMBA_CACHE_DIR=/kernels /opt/slipjump/bin/slipjump warm

FROM python:3.11-slim
RUN useradd --system --uid 10001 --home-dir /var/lib/slipjump --create-home slipjump
COPY --from=build /opt/slipjump /opt/slipjump
# numba wants its cache writable
COPY --from=build --chown=slipjump /kernels /var/cache/slipjump
ENV PATH=/opt/slipjump/bin:$PATH NUMBA_CACHE_DIR=/var/cache/slipjump OPENBLAS_NUM_THREADS=1
USER slipjump
WORKDIR /var/lib/slipjump
VOLUME /var/lib/slipjump
STOPSIGNAL SIGTERM
# /live needs agent.http in the configuration, on its default port; it says nothing of the plant
HEALTHCHECK --interval=30s --timeout=5s --start-period=120s --retries=3 \
  CMD ["python", "-c", "import urllib.request; urllib.request.urlopen('http://127.0.0.1:9187/live', timeout=4)"]
ENTRYPOINT ["slipjump"]
CMD ["run", "/etc/slipjump/plant.yaml", "--log-format", "json"]
